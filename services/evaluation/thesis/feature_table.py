# SPDX-License-Identifier: Apache-2.0
"""The balance of features as text, as JSON and as a picture."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.ticker import MaxNLocator

from schemas.records import MotionState
from services.evaluation.bench.table import NOTHING, BenchTable
from services.evaluation.pictures.figure import new_figure, save_figure
from services.evaluation.run.outcome import Report
from services.evaluation.thesis.feature_balance import Kept, SequenceBalance

_COLOURS = {Kept.ALL: "#808080", Kept.WITHOUT_DYNAMIC: "#d62728", Kept.WITHOUT_MOVING: "#2e8b57"}
_UNDECIDED = (MotionState.UNDECIDED, MotionState.POTENTIALLY_DYNAMIC)
_CAR = "car"
_STEP = 0.02


def objects_table(sequences: Sequence[SequenceBalance]) -> BenchTable:
    """How many of the objects seen are parked: observations, an object in a frame being one."""
    header = (
        "sequence",
        "frames",
        "without masks",
        "objects seen",
        "undecided or unknown",
        "parked",
        "parked, cars alone",
    )
    rows = []
    for item in sequences:
        seen = item.observations((None, *MotionState))
        undecided = item.observations((None, *_UNDECIDED))
        shares = (_percent(item.parked_share()), _percent(item.parked_share(_CAR)))
        rows.append((item.name, str(len(item.frames)), str(item.without_masks), str(seen), str(undecided), *shares))
    return BenchTable(header, tuple(rows))


def skew_table(sequences: Sequence[SequenceBalance]) -> BenchTable:
    """A row a sequence and kind: the mean of (right - left) / (right + left), its spread, and features a frame."""
    header = ("sequence", "features kept", "skew, mean", "skew, standard deviation", "|skew|, mean", "features a frame")
    rows = []
    for item in sequences:
        for kept in Kept:
            values = _skew_numbers(item, kept)
            features = item.mean_features(kept)
            count = NOTHING if features is None else f"{features:.0f}"
            rows.append((item.name, kept.value, *(_signed(value) for value in values), count))
    return BenchTable(header, tuple(rows))


def describe_balance(sequences: Sequence[SequenceBalance]) -> Report:
    """All of it for JSON, frame by frame."""
    return {item.name: _describe(item) for item in sequences}


def plot_skews(sequences: Sequence[SequenceBalance], path: Path) -> None:
    """A histogram a sequence of every frame's skew; a line stands at each mean."""
    figure = new_figure(height_in=0.6 + 2.6 * len(sequences), width_in=7.5)
    rows = figure.subplots(len(sequences), 1, squeeze=False, sharex=True).ravel()
    largest = max(
        (float(np.abs(item.skews(kept)).max(initial=0.0)) for item in sequences for kept in Kept), default=0.0
    )
    edge = _STEP * (np.floor(largest / _STEP) + 1.0)
    bins = np.arange(-edge, edge + _STEP / 2, _STEP)
    for item, axes in zip(sequences, rows, strict=True):
        for kept in Kept:
            if not item.knows(kept):
                continue
            skews = item.skews(kept)
            label = f"{kept.value}: {skews.mean():+.3f}" if skews.size else kept.value
            axes.hist(skews, bins, histtype="stepfilled", alpha=0.35, color=_COLOURS[kept], label=label)
            if skews.size:
                axes.axvline(float(skews.mean()), color=_COLOURS[kept], linewidth=1.5)
        axes.axvline(0.0, color="black", linewidth=0.6, linestyle=":")
        axes.set_title(item.name, fontsize=10)
        axes.set_ylabel("frames")
        axes.yaxis.set_major_locator(MaxNLocator(integer=True))
        axes.legend(fontsize=8)
    rows[-1].set_xlabel("skew (right - left) / (right + left): all left -1, all right 1")
    save_figure(figure, path)


def _describe(item: SequenceBalance) -> Report:
    return {
        "frames": len(item.frames),
        "without_masks": item.without_masks,
        "parked_share": item.parked_share(),
        "parked_share_cars": item.parked_share(_CAR),
        "observations": {
            "standing": item.observations((MotionState.NON_MOVING, MotionState.STATIC)),
            "moving": item.observations((MotionState.MOVING,)),
            "undecided": item.observations(_UNDECIDED),
            "unknown": item.observations((None,)),
        },
        "skew": {
            kept.value: dict(zip(("mean", "std", "mean_absolute"), _skew_numbers(item, kept), strict=True))
            | {"features": item.mean_features(kept)}
            for kept in Kept
        },
        "by_frame": {
            frame.name: {kept.value: [halves.left, halves.right] for kept, halves in frame.halves.items()}
            for frame in item.frames
        },
    }


def _skew_numbers(item: SequenceBalance, kept: Kept) -> tuple[float | None, float | None, float | None]:
    skews = item.skews(kept)
    if not item.knows(kept) or not skews.size:
        return None, None, None
    return float(skews.mean()), float(skews.std()), float(np.abs(skews).mean())


def _signed(value: float | None) -> str:
    return NOTHING if value is None else f"{value:+.3f}"


def _percent(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.1%}"
