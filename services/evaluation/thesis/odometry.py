# SPDX-License-Identifier: Apache-2.0
"""Tables 5.2 and 5.3 of the thesis: the error of every trial of a stage, their average, and what others published."""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from services.evaluation.bench.runs import LEAST_COVERAGE, BenchRun, RunStatus
from services.evaluation.bench.table import NOTHING, BenchTable, groups
from services.evaluation.run.outcome import Report
from services.evaluation.thesis.published import PUBLISHED_ODOMETRY


@dataclass(frozen=True)
class StageErrors:
    """The trials of one stage on one sequence, in the order of their seeds."""

    sequence: str
    stage: str
    runs: tuple[BenchRun, ...]

    @property
    def errors_m(self) -> tuple[float | None, ...]:
        """ATE RMSE of each trial after Sim(3) alignment; None for one that was lost or failed."""
        return tuple(
            run.measures.ate_sim3_m if run.measures is not None and run.status is RunStatus.TRACKED else None
            for run in self.runs
        )

    @property
    def known_m(self) -> list[float]:
        """The errors of the trials that count."""
        return [error for error in self.errors_m if error is not None]

    @property
    def average_m(self) -> float | None:
        """The mean, as the thesis has it, over the trials that count; None where none does."""
        return statistics.fmean(self.known_m) if self.known_m else None

    @property
    def middle_run(self) -> BenchRun | None:
        """The trial whose error is the median, the lower of two: what pictures show."""
        counted = [(error, run) for error, run in zip(self.errors_m, self.runs, strict=True) if error is not None]
        counted.sort(key=lambda one: one[0])
        return counted[(len(counted) - 1) // 2][1] if counted else None


def stage_errors(runs: Sequence[BenchRun]) -> list[StageErrors]:
    """The runs by sequence and stage, in the order in which they come."""
    return [
        StageErrors(sequence, stage, tuple(run for run in runs if (run.input, run.variant) == (sequence, stage)))
        for sequence, stage in groups(runs)
    ]


def trials_table(rows: Sequence[StageErrors], stage: str) -> BenchTable:
    """The layout of tables 5.2 and 5.3: a row a sequence, T1 to Tn, the average, the least share of frames tracked."""
    chosen = [row for row in rows if row.stage == stage]
    most = max((len(row.runs) for row in chosen), default=0)
    header = ("sequence", *(f"T{number + 1}" for number in range(most)), "average", "tracked, least")
    table = []
    for row in chosen:
        cells = [_cell(run, error) for run, error in zip(row.runs, row.errors_m, strict=True)]
        cells += [NOTHING] * (most - len(cells))
        left_out = len(row.runs) - len(row.known_m)
        average = _metres(row.average_m) + (f" ({len(row.known_m)} of {len(row.runs)})" if left_out else "")
        table.append((row.sequence, *cells, average, _least_tracked(row)))
    return BenchTable(header, tuple(table))


def comparison_table(rows: Sequence[StageErrors], *, whole_sequences: bool) -> BenchTable:
    """A row a sequence: what was published, then our average of each stage.

    Published numbers are of whole sequences; beside a part of one they are left out.
    """
    stages = list(dict.fromkeys(row.stage for row in rows))
    header = ("sequence", *(column.name for column in PUBLISHED_ODOMETRY), *(f"kinemap, {stage}" for stage in stages))
    table = []
    for sequence in dict.fromkeys(row.sequence for row in rows):
        published = [column.ate_m.get(sequence) if whole_sequences else None for column in PUBLISHED_ODOMETRY]
        ours = {row.stage: row.average_m for row in rows if row.sequence == sequence}
        table.append((sequence, *map(_metres, published), *(_metres(ours.get(stage)) for stage in stages)))
    return BenchTable(header, tuple(table))


def describe_odometry(rows: Sequence[StageErrors], *, frames: int | None) -> Report:
    """All of it for JSON. `frames`: how many of each sequence were driven, None for all."""
    return {
        "frames": frames,
        "least_coverage": LEAST_COVERAGE,
        "published": [
            {"name": column.name, "source": column.source, "ate_m": dict(column.ate_m)} for column in PUBLISHED_ODOMETRY
        ],
        "rows": [
            {
                "sequence": row.sequence,
                "stage": row.stage,
                "ate_m": list(row.errors_m),
                "average_m": row.average_m,
                "coverage": [None if run.measures is None else run.measures.coverage for run in row.runs],
                "verdicts": [run.verdict for run in row.runs],
            }
            for row in rows
        ],
    }


def _cell(run: BenchRun, error: float | None) -> str:
    if error is not None:
        return _metres(error)
    if run.status is RunStatus.LOST and run.measures is not None:
        return f"lost ({run.measures.coverage:.0%})"
    return "failed" if run.status is RunStatus.FAILED else NOTHING


def _least_tracked(row: StageErrors) -> str:
    known = [run.measures.coverage for run in row.runs if run.measures is not None]
    return f"{min(known):.1%}" if known else NOTHING


def _metres(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3f}"
