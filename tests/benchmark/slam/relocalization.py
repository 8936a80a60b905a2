# SPDX-License-Identifier: Apache-2.0
"""A lost camera, found again in an earlier drive's map: `python -m tests.benchmark.slam.relocalization --help`.

Second drives are data sets of `kinemap simulate` through the first one's town: another light, other traffic, a way
beside. Each frame that is tried comes after a black one, so that none is found by following the one before.
"""

import argparse
from pathlib import Path

import numpy as np

from services.evaluation.trajectory.alignment import Alignment, align
from services.slam import _engine
from services.slam.vocabulary import SHIPPED_VOCABULARY
from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.engine_run import TRACKING, EngineRun, run_parts
from tests.benchmark.slam.sequence_part import SequencePart

BLACK_FRAMES = 40


def options_with(vocabulary: Path) -> _engine.EngineOptions:
    """Defaults, and these words."""
    options = _engine.EngineOptions()
    options.vocabulary_path = str(vocabulary)
    return options


def recognised(first: SequencePart, second: Path, count: int, every: int, vocabulary: Path) -> list[str]:
    """Found of tried frames of a second drive, error of their positions, time of a lost frame."""
    tried = range(0, count, every)
    parts = [first]
    for index in tried:
        parts += [SequencePart(second, index, 1, black=True), SequencePart(second, index, 1)]
    run = run_parts(tuple(parts), options_with(vocabulary))
    mapped = len(first.paths())
    asked = range(mapped + 1, len(run.results), 2)
    found = [number for number in asked if run.results[number].state == TRACKING]
    return [f"{len(found)} of {len(tried)}", _errors(run, parts, mapped, found), _times(run, asked)]


def _errors(run: EngineRun, parts: list[SequencePart], mapped: int, found: list[int]) -> str:
    truth = np.concatenate([part.true_poses() for part in parts])[:, :3, 3]
    indices, centers = run.centers()
    of_first = np.array(indices) < mapped
    world_from_map = align(centers[of_first], truth[np.array(indices)[of_first]], Alignment.SIM3)
    center_of = dict(zip(indices, world_from_map.points(centers), strict=True))
    errors = [float(np.linalg.norm(center_of[number] - truth[number])) for number in found if number in center_of]
    return f"{np.median(errors):.2f} ({max(errors):.2f})" if errors else "-"


def _times(run: EngineRun, asked: range) -> str:
    times = [run.wall_ms[number] for number in asked]
    return f"{np.median(times):.0f} ({max(times):.0f})"


def frames_until_found(folder: Path, before: int, vocabulary: Path) -> tuple[int | None, float]:
    """Frames lost after 40 black ones, and the slowest of them in ms; None for one that is not found within 20."""
    parts = (
        SequencePart(folder, 0, before),
        SequencePart(folder, before, BLACK_FRAMES, black=True),
        SequencePart(folder, before, 20),
    )
    run = run_parts(parts, options_with(vocabulary))
    back = before + BLACK_FRAMES
    first = next((i for i in range(back, len(run.results)) if run.results[i].state == TRACKING), None)
    slowest = max(run.wall_ms[back : (first or len(run.results) - 1) + 1])
    same_map = first is not None and run.results[first].map_id == run.results[before - 1].map_id
    return (first - back if same_map and first is not None else None), slowest


def main() -> None:
    """Run the benchmark and put its table on the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=Path, help="a simulated sequence's folder (.../sequences/00)")
    parser.add_argument("--second", type=Path, nargs="*", default=[], help="others through the same town")
    parser.add_argument("--black", type=Path, nargs="*", default=[], help="sequences cut by 40 black frames")
    parser.add_argument("--frames", type=int, default=160, help="of each drive")
    parser.add_argument("--every", type=int, default=4)
    parser.add_argument("--vocabulary", type=Path, default=SHIPPED_VOCABULARY)
    parser.add_argument("--dry", action="store_true", help="print only")
    arguments = parser.parse_args()
    rows = []
    for second in arguments.second:
        first = SequencePart(arguments.first, 0, arguments.frames)
        cells = recognised(first, second, arguments.frames, arguments.every, arguments.vocabulary)
        rows.append([second.resolve().parent.parent.name, *cells])
        print(rows[-1], flush=True)
    for folder in arguments.black:
        lost, slowest = frames_until_found(folder, 150, arguments.vocabulary)
        found = "not found" if lost is None else f"after {lost} frames"
        rows.append([f"{folder.name}, {BLACK_FRAMES} black frames", found, "-", f"({slowest:.0f})"])
        print(rows[-1], flush=True)
    header = ["second drive", "found", "error, median (largest) [m]", "a lost frame, median (largest) [ms]"]
    if not arguments.dry:
        put("relocalization", "python -m tests.benchmark.slam.relocalization", markdown_table(header, rows))


if __name__ == "__main__":
    main()
