# SPDX-License-Identifier: Apache-2.0
"""Save the map of one simulated drive, localise another drive of the same town in it, and compare with the truth.

    python -m tests.benchmark.slam.second_drive FIRST SECOND [SECOND ...] [--frames N] [--write]

FIRST and SECOND are data sets of `kinemap simulate` in KITTI's layout (grey and instances), of one seed; SECOND may
have other light, other traffic, another lane. The similarity that lays the first map onto the truth is found from the
first drive alone, and used for the others.
"""

import argparse
import json
import tempfile
import time
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.evaluation.trajectory.alignment import Alignment, Similarity, align
from services.slam import _engine
from services.slam.vocabulary import SHIPPED_VOCABULARY
from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.engine_run import TRACKING, EngineRun
from tests.benchmark.slam.sequence_part import SequencePart

Array = npt.NDArray[np.float64]
COMMAND = "python -m tests.benchmark.slam.second_drive FIRST SECOND ..."
HEADER = ("second drive", "frames", "tracked", "recognised after", "error median", "error p95", "largest", "of the way")


@dataclass(frozen=True)
class Drive:
    """One sequence of a data set."""

    folder: Path
    frames: int | None

    @property
    def sequence(self) -> Path:
        return next(iter(sorted((self.folder / "sequences").iterdir())))

    def world_centers_m(self) -> Array:
        """(N, 3) true camera centres in the simulator's world."""
        centers = np.loadtxt(self.folder / "poses" / f"{self.sequence.name}.txt").reshape(-1, 3, 4)[:, :, 3]
        about = json.loads((self.folder / "dataset.json").read_text())
        world = np.array(about["sequences"][self.sequence.name]["world_from_first_camera"])
        return np.asarray(centers @ world[:3, :3].T + world[:3, 3])[: self.frames]

    def engine(self, *, localize_only: bool = False) -> _engine.Engine:
        """One that has seen nothing yet."""
        part = SequencePart(self.sequence)
        height, width = next(iter(part.read())).image.shape
        options = _engine.EngineOptions()
        options.vocabulary_path = str(SHIPPED_VOCABULARY)
        options.localize_only = localize_only
        return _engine.Engine(_engine.CameraModel(width, height, *part.intrinsics(), []), options)

    def through(self, engine: _engine.Engine) -> EngineRun:
        """Every frame through the engine."""
        run = EngineRun(engine)
        for frame in islice(SequencePart(self.sequence).read(), self.frames):
            run.step(frame)
        return run


def map_of(drive: Drive, path: Path) -> tuple[Similarity, str]:
    """Drive through, save the map, and say where it lies in the world and what saving took."""
    run = drive.through(drive.engine())
    run.finish()
    start = time.perf_counter()
    run.engine.save_maps(str(path), in_background=False)
    save_ms = (time.perf_counter() - start) * 1e3
    indices, centers = run.centers()
    truth = drive.world_centers_m()[indices]
    similarity = align(centers, truth, Alignment.SIM3)
    ate_m = np.sqrt(((similarity.points(centers) - truth) ** 2).sum(axis=1).mean())
    keyframes = len(run.keyframes) - len(run.culled)
    size_mb = path.stat().st_size / 1e6
    return similarity, (
        f"First drive: {len(run.results)} frames, {run.tracked_share():.1%} tracked, ATE {ate_m:.2f} m. Its map: "
        f"{keyframes} keyframes, {len(run.landmarks)} landmarks, {size_mb:.1f} MB, saved in {save_ms:.0f} ms"
    )


def localised(drive: Drive, path: Path, world_from_map: Similarity) -> tuple[list[str], float]:
    """The table's row of a second drive, and how many ms loading took."""
    engine = drive.engine(localize_only=True)
    start = time.perf_counter()
    engine.load_maps(str(path))
    load_ms = (time.perf_counter() - start) * 1e3
    run = drive.through(engine)
    tracked = [index for index, result in enumerate(run.results) if result.state == TRACKING]
    truth = drive.world_centers_m()
    way_m = float(np.linalg.norm(np.diff(truth, axis=0), axis=1).sum())
    share = f"{len(tracked) / len(run.results):.1%}"
    if not tracked:
        return [drive.folder.name, str(len(run.results)), share, "never", "-", "-", "-", "-"], load_ms
    centers = np.array([run.results[index].map_from_camera[:3, 3] for index in tracked])
    errors = np.linalg.norm(world_from_map.points(centers) - truth[tracked], axis=1)
    middle, most, largest = np.percentile(errors, (50, 95, 100))
    metres = [f"{value:.2f} m" for value in (middle, most, largest)]
    row = [drive.folder.name, str(len(run.results)), share, f"{tracked[0]} frames", *metres, f"{most / way_m:.2%}"]
    return row, load_ms


def main() -> None:
    """Map one drive, localise the others in it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=Path)
    parser.add_argument("seconds", type=Path, nargs="+")
    parser.add_argument("--frames", type=int, help="of each drive")
    parser.add_argument("--map", type=Path, help="keep the map here")
    parser.add_argument("--write", action="store_true", help="put the table into docs/measurements.md")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = arguments.map or Path(folder) / "first.kmap"
        world_from_map, about = map_of(Drive(arguments.first, arguments.frames), path)
        rows = [localised(Drive(second, arguments.frames), path, world_from_map) for second in arguments.seconds]
    table = markdown_table(HEADER, [row for row, _ in rows])
    text = f"{about}, loaded in {rows[0][1]:.0f} ms. Errors by that drive's alignment.\n\n{table}"
    if arguments.write:
        put("second_drive", COMMAND, text)
    else:
        print(text)


if __name__ == "__main__":
    main()
