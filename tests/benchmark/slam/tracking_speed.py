# SPDX-License-Identifier: Apache-2.0
"""Time and memory of the engine on a KITTI odometry folder, beside OpenCV's ORB on the same images in the same run.

python -m tests.benchmark.slam.tracking_speed SEQUENCE [--frames N] [--rate-hz 10] [--threads 2]
Without --rate-hz each frame comes as soon as the one before is done; with it, not before its time.
"""

import argparse
import time
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np

from services.slam import _engine
from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.engine_pass import EnginePass
from tests.benchmark.slam.engine_run import EngineRun
from tests.benchmark.slam.sequence_part import SequencePart

ORB_EVERY = 10
FEATURES = 2000


@dataclass
class Measured:
    """One pass over a sequence."""

    run: EngineRun
    orb_ms: list[float] = field(default_factory=list)
    resident_mb: list[float] = field(default_factory=list)
    seconds: float = 0.0
    """from the first image to the last pose, reading the images and OpenCV's ORB left out"""


def resident_mb() -> float:
    """Memory this process holds now."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmRSS"))
    return int(line.split()[1]) / 1024


def measure(sequence: Path, frames: int | None, rate_hz: float | None, threads: int) -> Measured:
    """Drive the engine through the sequence's left images; every object of `instances/` counts as standing."""
    part = SequencePart(sequence, frames=frames)
    options = EnginePass((part,)).engine_options()
    options.features, options.threads = FEATURES, threads
    orb = cv2.ORB.create(FEATURES)
    cv2.setNumThreads(1)
    measured: Measured | None = None
    before_mb = 0.0
    started = time.perf_counter()
    for index, frame in enumerate(part.read()):
        image = frame.image
        if measured is None:
            before_mb = resident_mb()
            camera = _engine.CameraModel(image.shape[1], image.shape[0], *part.intrinsics())
            measured = Measured(EngineRun(_engine.Engine(camera, options)))
        if index % ORB_EVERY == 0:
            start = time.perf_counter()
            orb.detectAndCompute(image, None)
            measured.orb_ms.append((time.perf_counter() - start) * 1e3)
        if rate_hz is not None:
            time.sleep(max(0.0, started + index / rate_hz - time.perf_counter()))
        start = time.perf_counter()
        measured.run.step(frame)
        measured.seconds += time.perf_counter() - start
        measured.resident_mb.append(resident_mb() - before_mb)
    if measured is None:
        raise FileNotFoundError(f"{sequence / 'image_0'}: no images")
    return measured


def rows(measured: Measured) -> list[list[str]]:
    """The whole frame, its stages, OpenCV's ORB; median, 95th percentile, and the median in ORB's medians."""
    orb_ms = float(np.median(measured.orb_ms))
    stages = [result.stage_ms for result in measured.run.results]
    series = {"begin + finish": measured.run.wall_ms}
    series |= {name: [stage[name] for stage in stages] for name in stages[0]}
    series["OpenCV's ORB alone, one thread"] = measured.orb_ms
    return [
        [name, f"{np.percentile(ms, 50):.1f}", f"{np.percentile(ms, 95):.1f}", f"{np.median(ms) / orb_ms:.2f}"]
        for name, ms in series.items()
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence", type=Path)
    parser.add_argument("--frames", type=int)
    parser.add_argument("--rate-hz", type=float, help="the camera's; default: as fast as it goes")
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    measured = measure(arguments.sequence, arguments.frames, arguments.rate_hz, arguments.threads)
    frames, run = len(measured.run.results), measured.run
    summary = [
        f"{frames} frames of sequence {arguments.sequence.name}",
        f"{sum(result.keyframe_inserted for result in run.results)} keyframes",
        f"{100 * run.tracked_share():.1f} % tracked",
        f"{frames / measured.seconds:.1f} frames/s of engine time",
        f"memory grew by at most {max(measured.resident_mb):.0f} MB",
    ]
    table = markdown_table(["stage", "p50 [ms]", "p95 [ms]", "p50 / ORB"], rows(measured))
    pace = "fast" if arguments.rate_hz is None else "paced"
    options = "".join(
        f" --{name.replace('_', '-')} {value:g}"
        for name, value in vars(arguments).items()
        if name != "sequence" and value != parser.get_default(name)
    )
    command = f"python -m tests.benchmark.slam.tracking_speed SEQUENCE{options}"
    put(f"tracking-speed-{pace}", command, f"{', '.join(summary)}.\n\n{table}")


if __name__ == "__main__":
    main()
