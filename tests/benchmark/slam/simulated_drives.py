# SPDX-License-Identifier: Apache-2.0
"""Simulated drives that the engine's benchmarks share, made by `kinemap simulate` where they are not there yet.

`python -m tests.benchmark.slam.simulated_drives --drives FOLDER --seeds 1-3 static heavy` makes them beforehand.
"""

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from services.cli.simulate_seeds import parse_seeds

DRIVES = Path("build/drives")


@dataclass(frozen=True)
class DriveKind:
    """Frames of a round in the town and the simulator's settings; a round is 500 m at 8 m/s, less where it queues."""

    frames: int
    settings: tuple[str, ...]
    formats: str = "grey,instances"


KINDS = {
    "static": DriveKind(790, ("traffic=0",)),
    "parked": DriveKind(790, ("traffic=0", "parked=1", "parked_lanes=1")),
    "heavy": DriveKind(1550, ("traffic=1",)),
    "second": DriveKind(700, ("traffic=0.3", "traffic_seed=99", "light=overcast", "lateral_offset_m=1.0")),
}


def simulated_drive(kind: str, seed: int, drives: Path = DRIVES) -> Path:
    """The sequence's folder of a drive, rendered unless it is there whole; KeyError for a kind that is not one."""
    drive = KINDS[kind]
    folder = drives / f"{kind}_{seed:02}"
    description = folder / "dataset.json"
    if not (description.is_file() and json.loads(description.read_text())["complete"]):
        command = [sys.executable, "-m", "services.cli.app", "simulate", "--world", "town", "--size", "640x192"]
        command += ["--formats", drive.formats, "--jobs", "1", "--seed", str(seed), "--frames", str(drive.frames)]
        command += ["--out", str(folder), "--set", "simulator.loop_m=500"]
        for setting in drive.settings:
            command += ["--set", f"simulator.{setting}"]
        subprocess.run(command, check=True)
    return folder / "sequences" / "00"


def add_drive_arguments(parser: argparse.ArgumentParser, seeds: str) -> None:
    """--drives and --seeds."""
    parser.add_argument("--drives", type=Path, default=DRIVES, help="where simulated drives are kept")
    parser.add_argument("--seeds", type=parse_seeds, default=parse_seeds(seeds), help=f"of the town; {seeds}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Make what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinds", nargs="+", choices=list(KINDS))
    add_drive_arguments(parser, "1-10")
    given = parser.parse_args(arguments)
    for kind in given.kinds:
        for seed in given.seeds:
            print(simulated_drive(kind, seed, given.drives))


if __name__ == "__main__":
    main()
