# SPDX-License-Identifier: Apache-2.0
"""What the engine's benchmarks have in common: their flags, groups of passes, and how their figures are written."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from services.evaluation.bench.runs import LEAST_COVERAGE
from tests.benchmark.slam.engine_pass import EnginePass, PassReport
from tests.benchmark.slam.engine_run import TRACKING
from tests.benchmark.slam.kept_passes import KeptPasses, run_missing


def parser_of(description: str | None) -> argparse.ArgumentParser:
    """A parser that knows --jobs."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=1, help="passes at a time; times are worth something with 1")
    return parser


def add_kitti_argument(parser: argparse.ArgumentParser) -> None:
    """The folder of KITTI's sequences."""
    parser.add_argument("kitti", type=Path, help="KITTI odometry's folder `sequences`, with `poses` beside it")


def run_groups(
    groups: Mapping[str, Sequence[EnginePass]], jobs: int, kept: KeptPasses | None = None
) -> dict[str, list[PassReport]]:
    """Run all passes that are not kept, saying how each went, and give the reports by group."""
    passes = [(name, given) for name, of_group in groups.items() for given in of_group]
    reports: dict[str, list[PassReport]] = {name: [] for name in groups}
    for (name, given), report in zip(passes, run_missing([given for _, given in passes], jobs, kept), strict=True):
        print(f"{name}, {given.name}: ATE {report.ate_m:.3f} m, coverage {report.coverage:.1%}", flush=True)
        reports[name].append(report)
    return reports


def is_lost(report: PassReport) -> bool:
    """Whether it tracked too little for its error to say anything."""
    return report.coverage < LEAST_COVERAGE


def median_ate_m(reports: Sequence[PassReport]) -> float:
    """The median; a lost run counts as the worst."""
    return float(np.median([np.inf if is_lost(report) else report.ate_m for report in reports]))


def metres(value: float) -> str:
    """A length in a table."""
    return "lost" if np.isinf(value) else f"{value:.3f} m"


def tracked_after(report: PassReport, part: int) -> int | None:
    """How many frames into a part the camera is found again; None when it never is."""
    found = np.flatnonzero(report.states[report.part_starts[part] :] == TRACKING)
    return int(found[0]) if len(found) else None


def tracked_share(report: PassReport, part: int) -> float:
    """Share of a part's frames that were tracked in the map that holds most frames of the pass."""
    ends = [*report.part_starts, report.frames]
    inside = [index for index in report.indices if ends[part] <= index < ends[part + 1]]
    return len(inside) / (ends[part + 1] - ends[part])
