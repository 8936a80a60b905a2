# SPDX-License-Identifier: Apache-2.0
"""A benchmark's variants against each other, run by run: only runs of the same seed or repeat are compared."""

import statistics
from collections.abc import Mapping, Sequence

from services.evaluation.bench.runs import BenchRun, tracked
from services.evaluation.bench.table import NOTHING, BenchTable, Measure

ALL_INPUTS = "all"

Pair = tuple[BenchRun, BenchRun]

_LESS_IS_BETTER: dict[str, Measure] = {
    "ATE Sim(3)": lambda run: run.ate_sim3_m,
    "ATE SE(3)": lambda run: run.ate_se3_m,
    "RPE": lambda run: run.rpe_m,
    "KITTI segments": lambda run: run.segment_percent,
}
_MORE_IS_BETTER: dict[str, Measure] = {"frames/s": lambda run: run.frames_per_s}


def ratio_table(runs: Sequence[BenchRun]) -> BenchTable | None:
    """The last variant over each of the others: the median of the pairs' ratios, and in how many it is the better one.

    A pair of which one run was lost or failed has no ratio. None where there is no pair at all.
    """
    variants = list(dict.fromkeys(run.variant for run in runs))
    inputs = list(dict.fromkeys(run.input for run in runs))
    rows = []
    for other in variants[:-1]:
        pairs = {source: _pairs(runs, source, variants[-1], other) for source in inputs}
        if len(inputs) > 1:
            pairs[ALL_INPUTS] = [pair for of_one in pairs.values() for pair in of_one]
        rows += [
            (source, f"{variants[-1]} / {other}", str(len(of_one)), *_cells(of_one))
            for source, of_one in pairs.items()
            if of_one
        ]
    if not rows:
        return None
    header = ("input", "ratio", "pairs", *_LESS_IS_BETTER, *_MORE_IS_BETTER)
    return BenchTable(header, tuple(rows)).without_empty_columns(3)


def _pairs(runs: Sequence[BenchRun], source: str, variant: str, other: str) -> list[Pair]:
    others = {run.trial: run for run in tracked(runs, source, other)}
    return [(run, others[run.trial]) for run in tracked(runs, source, variant) if run.trial in others]


def _cells(pairs: Sequence[Pair]) -> list[str]:
    less = [_cell(ratios, [ratio < 1.0 for ratio in ratios]) for ratios in _ratios(pairs, _LESS_IS_BETTER)]
    more = [_cell(ratios, [ratio > 1.0 for ratio in ratios]) for ratios in _ratios(pairs, _MORE_IS_BETTER)]
    return less + more


def _ratios(pairs: Sequence[Pair], measures: Mapping[str, Measure]) -> list[list[float]]:
    found = []
    for measure in measures.values():
        values = [(_value(mine, measure), _value(others, measure)) for mine, others in pairs]
        found.append([mine / others for mine, others in values if mine is not None and others])
    return found


def _value(run: BenchRun, measure: Measure) -> float | None:
    return None if run.measures is None else measure(run.measures)


def _cell(ratios: Sequence[float], better: Sequence[bool]) -> str:
    return f"{statistics.median(ratios):.2f} (better in {sum(better)} of {len(ratios)})" if ratios else NOTHING
