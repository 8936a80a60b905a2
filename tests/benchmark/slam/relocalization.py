# SPDX-License-Identifier: Apache-2.0
"""A lost camera, found again in an earlier drive's map: `python -m tests.benchmark.slam.relocalization FIRST SECOND`.

FIRST and SECOND are data sets of `kinemap simulate` of one town: another light, other traffic, a way beside the first.
Each frame of SECOND that is tried comes after a black one, so that none is found by following the one before.
"""

import argparse
import json
import time
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from services.evaluation.trajectory.alignment import Alignment, align
from services.slam import _engine
from services.slam.vocabulary import SHIPPED_VOCABULARY
from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.engine_run import FRAME_NS, TRACKING, EngineRun
from tests.benchmark.slam.mask_objects import MaskObjects

Array = npt.NDArray[np.float64]


class SimulatedSequence:
    """Images, masks and true camera centres in the world (N, 3), m, of a simulated data set's first sequence."""

    def __init__(self, data_set: Path, frames: int | None = None) -> None:
        folder = data_set / "sequences" / "00"
        self.paths = sorted((folder / "image_0").iterdir())[:frames]
        self.objects = MaskObjects(folder / "instances", [path.stem for path in self.paths])
        described = json.loads((data_set / "dataset.json").read_text())["sequences"]["00"]
        world_from_first = np.array(described["world_from_first_camera"])
        poses = np.loadtxt(data_set / "poses" / "00.txt").reshape(-1, 3, 4)[: len(self.paths)]
        self.centers_m: Array = poses[:, :, 3] @ world_from_first[:3, :3].T + world_from_first[:3, 3]
        line = next(line for line in (folder / "calib.txt").read_text().splitlines() if line.startswith("P0"))
        self.projection: Array = np.array(line.split()[1:], float).reshape(3, 4)

    def image(self, index: int) -> npt.NDArray[np.uint8]:
        """Grey."""
        return np.asarray(cv2.imread(str(self.paths[index]), cv2.IMREAD_GRAYSCALE), np.uint8)


@dataclass
class Recognition:
    """What came of the frames that were tried."""

    tried: int = 0
    found: list[int] = field(default_factory=list)
    errors_m: list[float] = field(default_factory=list)
    ms: list[float] = field(default_factory=list)
    """Of every frame tried, features included."""

    def row(self, name: str) -> list[str]:
        """Cells of the table."""
        error = f"{np.median(self.errors_m):.2f} ({max(self.errors_m):.2f})" if self.errors_m else "-"
        times = f"{np.median(self.ms):.0f} ({max(self.ms):.0f})"
        return [name, f"{len(self.found)} of {self.tried}", error, times]


def map_of(sequence: SimulatedSequence, options: _engine.EngineOptions) -> EngineRun:
    """The engine after a first drive."""
    height, width = sequence.image(0).shape
    p = sequence.projection
    run = EngineRun(_engine.Engine(_engine.CameraModel(width, height, p[0, 0], p[1, 1], p[0, 2], p[1, 2]), options))
    for index in range(len(sequence.paths)):
        run.step(sequence.image(index), sequence.objects)
    return run


def recognise(run: EngineRun, first: SimulatedSequence, second: SimulatedSequence, every: int) -> Recognition:
    """Show the engine every so manieth frame of `second`, each after a black one."""
    indices, centers = run.centers()
    world_from_map = align(centers, first.centers_m[indices], Alignment.SIM3)
    black = np.zeros_like(first.image(0))
    nothing = np.zeros(black.shape, np.uint32), np.empty(0, np.uint32), np.empty(0, np.int32), np.empty(0, np.uint8)
    timestamp_ns = (len(run.results) + 1) * FRAME_NS
    recognition = Recognition()
    for index in range(len(second.paths)):
        track_image, ids, categories = second.objects.next_frame(index)
        if index % every:
            continue
        run.engine.begin_frame(timestamp_ns, black)
        run.engine.finish_frame(*nothing, True, None)
        image = second.image(index)
        start = time.perf_counter()
        run.engine.begin_frame(timestamp_ns + FRAME_NS, image)
        states = np.ones(len(ids), np.uint8)
        result = run.engine.finish_frame(track_image, ids, categories, states, True, None)
        recognition.ms.append((time.perf_counter() - start) * 1e3)
        timestamp_ns += 2 * FRAME_NS
        recognition.tried += 1
        if result.state != TRACKING:
            continue
        recognition.found.append(index)
        center = world_from_map.points(result.map_from_camera[None, :3, 3])[0]
        recognition.errors_m.append(float(np.linalg.norm(center - second.centers_m[index])))
    return recognition


def main() -> None:
    """Run the benchmark and put its table on the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("first", type=Path)
    parser.add_argument("second", type=Path, nargs="+")
    parser.add_argument("--frames", type=int, default=160, help="of the first drive")
    parser.add_argument("--second-frames", type=int, default=160)
    parser.add_argument("--every", type=int, default=3)
    parser.add_argument("--vocabulary", default=str(SHIPPED_VOCABULARY))
    parser.add_argument("--dry", action="store_true", help="print only")
    arguments = parser.parse_args()
    rows = []
    for path in [arguments.first, *arguments.second]:
        options = _engine.EngineOptions()
        options.vocabulary_path = arguments.vocabulary
        first = SimulatedSequence(arguments.first, arguments.frames)
        run = map_of(first, options)
        second = SimulatedSequence(path, arguments.second_frames)
        recognition = recognise(run, first, second, arguments.every)
        name = "the same again" if path == arguments.first else path.name
        rows.append(recognition.row(name))
        print(
            rows[-1], "not found:", sorted(set(range(0, len(second.paths), arguments.every)) - set(recognition.found))
        )
    table = markdown_table(
        ["second drive", "found", "error, median (largest) [m]", "a lost frame, median (largest) [ms]"], rows
    )
    if not arguments.dry:
        put("relocalization", "python -m tests.benchmark.slam.relocalization FIRST SECOND...", table)


if __name__ == "__main__":
    main()
