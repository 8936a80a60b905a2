# SPDX-License-Identifier: Apache-2.0
"""What became of the pixels of each class, and the IoU of what moves over the frames."""

from pathlib import Path

import numpy as np
from matplotlib.ticker import MaxNLocator

from schemas.records import MotionState
from services.evaluation.moving_masks.iou import MaskClass
from services.evaluation.moving_masks.score import MovingMaskResult
from services.evaluation.moving_masks.table import class_names
from services.evaluation.pictures.figure import new_figure, save_figure
from services.evaluation.run.plots import STATE_COLOURS

_COLOURS = {
    MaskClass.BACKGROUND: STATE_COLOURS[MotionState.STATIC],
    MaskClass.NON_MOVING: STATE_COLOURS[MotionState.NON_MOVING],
    MaskClass.MOVING: STATE_COLOURS[MotionState.MOVING],
}
_SMALLEST_WRITTEN = 0.06


def plot_confusion(result: MovingMaskResult, path: Path) -> None:
    """One bar a true class, parted by what its pixels were taken for."""
    total = result.total
    names = class_names(total)
    figure = new_figure(height_in=1.7 + 0.6 * len(total.classes))
    axes = figure.add_subplot()
    for place, true in enumerate(reversed(total.classes)):
        pixels = total.confusion[true].sum()
        left = 0.0
        for seen in total.classes:
            share = float(total.confusion[true, seen] / pixels) if pixels else 0.0
            axes.barh(place, share, left=left, color=_COLOURS[seen], edgecolor="white")
            if share >= _SMALLEST_WRITTEN:
                axes.text(left + share / 2, place, f"{share:.1%}", ha="center", va="center", fontsize=9)
            left += share
    axes.set_yticks(range(len(total.classes)), [f"truly {names[kind]}" for kind in reversed(total.classes)])
    axes.set_xlim(0.0, 1.0)
    axes.set_xlabel("share of pixels")
    for kind in total.classes:
        axes.barh([0], [0.0], color=_COLOURS[kind], label=f"found {names[kind]}")
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3, fontsize=8, frameon=False)
    figure.suptitle(f"what pixels are taken for, {len(result.by_frame)} frames", fontsize=10)
    save_figure(figure, path)


def plot_iou_over_frames(result: MovingMaskResult, path: Path) -> None:
    """IoU of moving and non-moving in each frame; a gap where neither truth nor estimate has any."""
    figure = new_figure(height_in=3.6)
    axes = figure.add_subplot()
    names = class_names(result.total)
    for kind in result.total.classes:
        if kind is MaskClass.BACKGROUND:
            continue
        iou = [score.iou(kind) for score in result.by_frame.values()]
        values = np.array([np.nan if value is None else value for value in iou])
        over_all = result.total.iou(kind)
        label = f"{names[kind]}: {over_all:.3f} over all" if over_all is not None else names[kind]
        axes.plot(values, marker=".", markersize=3, linewidth=1.0, color=_COLOURS[kind], label=label)
    axes.set_ylim(-0.02, 1.03)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_xlabel("frame")
    axes.set_ylabel("IoU")
    axes.set_title("IoU of each frame's masks", fontsize=10)
    axes.grid(visible=True, linewidth=0.3)
    axes.legend(loc="best", fontsize=8)
    save_figure(figure, path)
