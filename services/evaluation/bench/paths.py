# SPDX-License-Identifier: Apache-2.0
"""The paths of a benchmark's runs beside the truth, read from the runs' folders."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from services.evaluation.bench.runs import BenchRun, RunStatus
from services.evaluation.run.folder import TRAJECTORY_NAME, TRUTH_NAME
from services.evaluation.trajectory.alignment import Alignment
from services.evaluation.trajectory.error import TrajectoryError, trajectory_error
from services.evaluation.trajectory.files import read_trajectory
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError


@dataclass(frozen=True)
class RunPath:
    """A run's path after the map's last correction, the truth, and the error between them, aligned by Sim(3)."""

    estimate: Trajectory
    truth: Trajectory
    error: TrajectoryError


def read_paths(runs: Iterable[BenchRun], folder: Path) -> dict[str, RunPath]:
    """By the run's folder, the path of each run in `folder` that was tracked and has a truth."""
    paths = {}
    for run in runs:
        files = [folder / run.folder / name for name in (TRAJECTORY_NAME, TRUTH_NAME)]
        if run.status is not RunStatus.TRACKED or not all(file.is_file() for file in files):
            continue
        try:
            estimate, truth = (read_trajectory(file) for file in files)
            paths[run.folder] = RunPath(estimate, truth, trajectory_error(estimate, truth, Alignment.SIM3))
        except InputError:
            continue  # a path that cannot be read or has no error has no place in a picture of errors
    return paths
