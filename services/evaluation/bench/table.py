# SPDX-License-Identifier: Apache-2.0
"""A benchmark's summary: every input and variant in one row of medians and spreads."""

import statistics
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from services.evaluation.bench.runs import BenchRun, RunMeasures, RunStatus, tracked

NOTHING = "-"

_MEBIBYTE = 1024 * 1024
_STANDING = ("non_moving", "potentially_dynamic", "undecided")
# input, variant, runs, coverage: what a run that does not count is told in
_FIXED_COLUMNS = 4

Measure = Callable[[RunMeasures], float | None]


class BenchTable(NamedTuple):
    """A table in plain text, row by row."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def without_empty_columns(self, first: int) -> "BenchTable":
        """The first columns, and of the others those in which any row says anything."""
        kept = [
            index
            for index in range(len(self.header))
            if index < first or any(row[index] not in ("", NOTHING) for row in self.rows)
        ]
        return BenchTable(
            tuple(self.header[index] for index in kept), tuple(tuple(row[index] for index in kept) for row in self.rows)
        )


def groups(runs: Iterable[BenchRun]) -> list[tuple[str, str]]:
    """(input, variant) pairs in the order in which the runs come."""
    return list(dict.fromkeys((run.input, run.variant) for run in runs))


def summary_table(runs: Sequence[BenchRun], *, with_setbacks: bool = True) -> BenchTable:
    """One row an input and variant; below it, each of its runs that was lost or failed, for it is not in its numbers.

    Numbers are medians over the runs that were tracked, with the least and the largest beside them where there are
    several.
    """
    header: tuple[str, ...] = ()
    rows: list[tuple[str, ...]] = []
    for source, variant in groups(runs):
        group = [run for run in runs if (run.input, run.variant) == (source, variant)]
        cells = {"input": source, "variant": variant, **_summary(group)}
        header = tuple(cells)
        rows.append(tuple(cells.values()))
        if with_setbacks:
            filler = ("",) * (len(cells) - _FIXED_COLUMNS)
            rows.extend((source, variant, run.trial, run.verdict, *filler) for run in setbacks(group))
    return BenchTable(header, tuple(rows)).without_empty_columns(_FIXED_COLUMNS)


def setbacks(runs: Iterable[BenchRun]) -> list[BenchRun]:
    """The runs that were lost or failed."""
    return [run for run in runs if run.status is not RunStatus.TRACKED]


def median_of(runs: Iterable[BenchRun], measure: Measure) -> float | None:
    """The median of a measure over the runs that have it."""
    values = _known(runs, measure)
    return statistics.median(values) if values else None


def _summary(group: Sequence[BenchRun]) -> dict[str, str]:
    done = tracked(group, group[0].input, group[0].variant)

    def landmarks(*labels: str) -> str:
        return _median(done, lambda run: float(sum(run.landmarks.get(label, 0) for label in labels)))

    def frames(level: str) -> str:
        return _median(done, lambda run: float(run.density_frames.get(level, 0)))

    return {
        "runs": _count(group),
        "coverage, median (least)": _coverage(group),
        "ATE Sim(3) [m]": _spread(done, lambda run: run.ate_sim3_m, 3),
        "ATE SE(3) [m]": _spread(done, lambda run: run.ate_se3_m, 3),
        "RPE a frame [m]": _spread(done, lambda run: run.rpe_m, 3),
        "RPE a frame [deg]": _spread(done, lambda run: run.rpe_deg, 3),
        "KITTI segments [%]": _spread(done, lambda run: run.segment_percent, 2),
        "KITTI segments [deg/100 m]": _spread(done, lambda run: run.segment_deg_per_100_m, 2),
        "moving flag precision": _spread(done, lambda run: run.flag_precision, 3),
        "moving flag recall": _spread(done, lambda run: run.flag_recall, 3),
        "landmarks static / standing / moving": _joined(
            (landmarks("static"), landmarks(*_STANDING), landmarks("moving"))
        ),
        "density unknown / low / high [frames]": _joined((frames("unknown"), frames("low"), frames("high"))),
        "frames/s": _spread(done, lambda run: run.frames_per_s, 1),
        "peak memory [MiB]": _spread(done, _memory_mib, 0),
    }


def _memory_mib(run: RunMeasures) -> float | None:
    return None if run.peak_memory_bytes is None else run.peak_memory_bytes / _MEBIBYTE


def _count(group: Sequence[BenchRun]) -> str:
    statuses = [run.status for run in group]
    words = [
        f"{statuses.count(status)} {status}" for status in (RunStatus.LOST, RunStatus.FAILED) if status in statuses
    ]
    return ", ".join((str(len(group)), *words))


def _coverage(group: Sequence[BenchRun]) -> str:
    coverages = _known([run for run in group if run.status is not RunStatus.FAILED], lambda run: run.coverage)
    return f"{statistics.median(coverages):.1%} ({min(coverages):.1%})" if coverages else NOTHING


def _spread(runs: Sequence[BenchRun], measure: Measure, digits: int) -> str:
    values = _known(runs, measure)
    if len(values) < 2:
        return f"{values[0]:.{digits}f}" if values else NOTHING
    return f"{statistics.median(values):.{digits}f} [{min(values):.{digits}f}..{max(values):.{digits}f}]"


def _median(runs: Sequence[BenchRun], measure: Measure) -> str:
    value = median_of(runs, measure)
    return NOTHING if value is None else f"{value:.0f}"


def _joined(cells: Sequence[str]) -> str:
    return NOTHING if all(cell == NOTHING for cell in cells) else " / ".join(cells)


def _known(runs: Iterable[BenchRun], measure: Measure) -> list[float]:
    values = (measure(run.measures) for run in runs if run.measures is not None)
    return [value for value in values if value is not None]
