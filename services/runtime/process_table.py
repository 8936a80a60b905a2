# SPDX-License-Identifier: Apache-2.0
"""The one table of processes: what runs, with how many threads, and in which order it is spawned.

supervisord (services.cli.supervisord_config), the systemd units and the compose file in deploy/ all say what stands
here; tests/unit/cli holds them against it.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class ServiceProcess:
    """One row: a process that runs `python -m <module> --config FILE`."""

    name: str
    module: str
    priority: int
    """spawned in ascending order; readiness does not follow from it, the camera waits for those it needs"""
    threads: int = 1
    """for OpenMP, BLAS and OpenCV: pools of several processes fight over few cores"""
    stop_wait_s: int = 10
    """how long it may take to do what has already arrived, before it is killed"""
    has_liveliness: bool = True
    """it tells on the bus when it is ready"""


PROCESSES: tuple[ServiceProcess, ...] = (
    ServiceProcess("bus", "services.runtime.entry_point", 10, has_liveliness=False),
    ServiceProcess("recorder", "services.recorder.service", 20, stop_wait_s=30),
    ServiceProcess("mapstore", "services.mapstore.service", 30, stop_wait_s=30),
    ServiceProcess("slam", "services.slam.service", 40, stop_wait_s=30),
    ServiceProcess("tracker", "services.tracker.service", 50),
    ServiceProcess("motion", "services.motion.service", 60),
    ServiceProcess("segmenter", "services.segmenter.service", 70),
    ServiceProcess("camera", "services.camera.service", 80),
)
"""From the end of the data flow to its beginning, so that who receives is spawned before who sends."""

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


def environment_of(process: ServiceProcess) -> dict[str, str]:
    """What the environment of a process says about threads; waiting threads sleep instead of spinning."""
    return {**{name: str(process.threads) for name in THREAD_VARIABLES}, "OMP_WAIT_POLICY": "passive"}
