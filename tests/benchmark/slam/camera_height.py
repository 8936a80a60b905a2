# SPDX-License-Identifier: Apache-2.0
"""Metres from the camera's height above the road: how far off the scale is, with nothing but the start aligned.

python -m tests.benchmark.slam.camera_height SEQUENCE... [--camera-height-m 1.65] [--start 0 60] [--frames N]
    [--write]

A sequence is a folder in KITTI's layout, real or made by `kinemap simulate`, whose data set tells its own height.
"""

import argparse
import json
from pathlib import Path

import numpy as np

from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.engine_pass import EnginePass, PassReport, run_passes
from tests.benchmark.slam.sequence_part import SequencePart

COMMAND = "python -m tests.benchmark.slam.camera_height SEQUENCE... --write"
ARBITRARY = "stays arbitrary"
HEADER = (
    "sequence",
    "from frame",
    "frames",
    "camera height",
    "scale off by",
    "ATE without scale (SE(3))",
    "ATE (Sim(3))",
)


def told_height_m(sequence: Path) -> float | None:
    """What the simulator says about its camera; None for a real recording."""
    file = sequence.resolve().parent.parent / "dataset.json"
    if not file.is_file():
        return None
    return float(json.loads(file.read_text())["options"]["simulator"]["camera_height_m"])


def name_of(sequence: Path) -> str:
    """A simulated sequence by its data set, a real one by its number."""
    folder = sequence.resolve()
    return folder.name if told_height_m(folder) is None else folder.parent.parent.name


def row(sequence: Path, start: int, height_m: float, report: PassReport) -> list[str]:
    """One run's line of the table."""
    return [
        name_of(sequence),
        str(start),
        str(report.frames),
        f"{height_m:.2f} m",
        f"{100 * abs(report.scale - 1):.1f} %" if report.metric else ARBITRARY,
        f"{report.ate_se3_m:.2f} m" if report.metric else "-",
        f"{report.ate_m:.2f} m",
    ]


def main() -> None:
    """Run every sequence from every start."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequences", type=Path, nargs="+", metavar="SEQUENCE")
    parser.add_argument("--camera-height-m", type=float, help="of the sequences that do not tell it themselves")
    parser.add_argument("--start", type=int, nargs="+", default=[0])
    parser.add_argument("--frames", type=int)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--write", action="store_true", help="put the table on docs/measurements.md")
    given = parser.parse_args()
    runs: list[tuple[Path, int, float]] = []
    for sequence in given.sequences:
        height_m = told_height_m(sequence) or given.camera_height_m
        if height_m is None:
            parser.error(f"{sequence}: does not tell its camera's height; expected --camera-height-m")
        runs += [(sequence, start, height_m) for start in given.start]
    passes = [
        EnginePass((SequencePart(sequence, start, given.frames),), "moving", {"camera_height_m": height_m})
        for sequence, start, height_m in runs
    ]
    rows = []
    for (sequence, start, height_m), report in zip(runs, run_passes(passes, given.jobs), strict=True):
        rows.append(row(sequence, start, height_m, report))
        print(" | ".join(rows[-1]), flush=True)
    off = [float(line[4].split()[0]) for line in rows if line[4] != ARBITRARY] or [float("nan")]
    rows.append(["median (worst)", "", "", "", f"{np.median(off):.1f} % ({max(off):.1f} %)", "", ""])
    print(" | ".join(rows[-1]))
    if given.write:
        put("camera-height", COMMAND, markdown_table(HEADER, rows))


if __name__ == "__main__":
    main()
