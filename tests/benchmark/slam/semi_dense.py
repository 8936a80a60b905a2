# SPDX-License-Identifier: Apache-2.0
"""Measure the semi-dense map: how many points, how true, at what cost; put the table on docs/measurements.md.

python -m tests.benchmark.slam.semi_dense NAME=SEQUENCE... [--pictures FOLDER] [--frames N] [--write]

A sequence is a folder in KITTI's layout (image_0, calib.txt, instances, ../../poses/NN.txt). Depths are compared with
its `depth` (of the simulator), else with stereo where there is an `image_1`, else with motion stereo over the true
poses. Stereo and motion stereo are wrong themselves: on KITTI 06 they differ from each other by 2.4 % in the median.
"""

import argparse
import time
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from services.slam import _engine
from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.engine_run import EngineRun, run_parts
from tests.benchmark.slam.motion_stereo import MotionStereo
from tests.benchmark.slam.semi_dense_picture import cloud_picture, depth_picture
from tests.benchmark.slam.semi_dense_run import (
    Judge,
    SemiDenseClouds,
    metres_per_unit,
    relative_errors,
    simulated_depth,
    stereo_depth,
)
from tests.benchmark.slam.sequence_part import SequencePart

COMMAND = "python -m tests.benchmark.slam.semi_dense NAME=SEQUENCE... --write"
MOTION_STEREO_EVERY = 12
"""of so many keyframes one is compared with motion stereo, which takes eleven seconds an image"""
HEAD = [
    "sequence",
    "frames",
    "landmarks",
    "semi-dense points",
    "times",
    "compared with",
    "points compared",
    "median error",
    "90 % below",
    "off by over 10 %",
    "ms of CPU a keyframe",
]


@dataclass(frozen=True)
class Measured:
    """One sequence's run with the semi-dense map on."""

    run: EngineRun
    clouds: SemiDenseClouds
    intrinsics: npt.NDArray[np.float64]
    scale: float
    cpu_ms_per_keyframe: float


def measure(sequence: Path, frames: int | None) -> Measured:
    """Run the sequence twice, without and with."""
    part = SequencePart(sequence, frames=frames)
    seconds = []
    for semi_dense in (False, True):
        options = _engine.EngineOptions()
        options.semi_dense = semi_dense
        clouds = SemiDenseClouds()
        start = time.process_time()
        run = run_parts((part,), options, clouds.take)
        seconds.append(time.process_time() - start)
    scale = metres_per_unit(run, part.true_poses()[:, :3, 3])
    cost_ms = (seconds[1] - seconds[0]) * 1e3 / max(1, len(clouds.of_keyframe))
    return Measured(run, clouds, projection(sequence, "P0")[:, :3], scale, cost_ms)


def projection(sequence: Path, name: str) -> npt.NDArray[np.float64]:
    """A camera's (3, 4) matrix of calib.txt, in pixels."""
    lines = (sequence / "calib.txt").read_text().splitlines()
    return np.array(next(line for line in lines if line.startswith(name)).split()[1:], float).reshape(3, 4)


def judge_of(sequence: Path) -> Judge:
    """What a sequence's depths are compared with."""
    if (sequence / "depth").is_dir():
        return Judge("true depth", simulated_depth(sequence / "depth"))
    if (sequence / "image_1").is_dir():
        focal_baseline_px_m = -projection(sequence, "P1")[0, 3]
        return Judge("stereo", stereo_depth(sequence / "image_0", sequence / "image_1", focal_baseline_px_m))
    part = SequencePart(sequence)
    sweep = MotionStereo(part.paths(), part.true_poses(), projection(sequence, "P0")[:, :3])
    return Judge("motion stereo", sweep.depth, MOTION_STEREO_EVERY)


def table_row(name: str, measured: Measured, compared_with: str, errors: npt.NDArray[np.float64]) -> list[str]:
    """The table's row of one sequence."""
    landmarks, points = len(measured.run.landmarks), measured.clouds.points()
    row = [name, str(len(measured.run.results)), str(landmarks), str(points), f"{points / max(1, landmarks):.0f}"]
    sizes = np.abs(errors)
    figures = (np.median(sizes), np.percentile(sizes, 90), (sizes > 0.1).mean())
    compared = [compared_with, str(len(errors))]
    return [*row, *compared, *(f"{100 * part:.1f} %" for part in figures), f"{measured.cpu_ms_per_keyframe:.0f}"]


def write_pictures(folder: Path, name: str, sequence: Path, measured: Measured) -> None:
    """NAME_depth.png and NAME_cloud.png."""
    folder.mkdir(parents=True, exist_ok=True)
    images = sorted((sequence / "image_0").iterdir())
    depth = depth_picture(measured.clouds, images, measured.intrinsics, measured.scale)
    cv2.imwrite(str(folder / f"{name}_depth.png"), depth)
    cv2.imwrite(str(folder / f"{name}_cloud.png"), cloud_picture(measured.clouds, measured.scale))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequences", nargs="+", metavar="NAME=SEQUENCE")
    parser.add_argument("--frames", type=int)
    parser.add_argument("--pictures", type=Path)
    parser.add_argument("--write", action="store_true", help="put the table on docs/measurements.md")
    arguments = parser.parse_args()
    rows = []
    for assignment in arguments.sequences:
        name, _, path = assignment.partition("=")
        sequence = Path(path).resolve()
        measured = measure(sequence, arguments.frames)
        judge = judge_of(sequence)
        errors = relative_errors(measured.clouds, measured.intrinsics, measured.scale, judge)
        rows.append(table_row(name, measured, judge.name, errors))
        print(dict(zip(HEAD, rows[-1], strict=True)))
        if arguments.pictures is not None:
            write_pictures(arguments.pictures, name, sequence, measured)
    if arguments.write:
        put("semi-dense", COMMAND, markdown_table(HEAD, rows))


if __name__ == "__main__":
    main()
