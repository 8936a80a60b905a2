# SPDX-License-Identifier: Apache-2.0
"""Precision over recall of every category, and its average precision over IoU."""

from collections.abc import Mapping
from pathlib import Path

from services.evaluation.figure import new_figure, save_figure
from services.evaluation.instance_masks import THESIS_IOUS, MaskPrecision
from services.evaluation.instance_masks_found import FoundRules, FoundScore


def plot_precision_recall(found: Mapping[str, FoundScore], rules: FoundRules, path: Path) -> None:
    """One curve a category, from the surest instances to all; the dot is where `minimum_score` stands."""
    figure = new_figure(height_in=5.5, width_in=6.5)
    axes = figure.add_subplot()
    for number, (name, score) in enumerate(found.items()):
        if score.recall is None:
            continue
        colour = f"C{number % 10}"
        axes.plot(score.recalls, score.precisions, color=colour, label=name, drawstyle="steps-pre")
        if score.precision is not None:
            axes.plot([score.recall], [score.precision], marker="o", color=colour)
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, 1.03)
    axes.set_xlabel("recall")
    axes.set_ylabel("precision")
    axes.set_title(
        f"IoU {rules.minimum_iou:g}, {rules.minimum_height_px:g} px high and more; dot: score {rules.minimum_score:g}",
        fontsize=10,
    )
    axes.grid(visible=True, linewidth=0.3)
    if axes.lines:
        axes.legend(loc="lower left", fontsize=8)
    save_figure(figure, path)


def plot_precision_by_iou(score: MaskPrecision, path: Path) -> None:
    """Average precision at every IoU from 0 to 1, whose mean the thesis compares networks by."""
    figure = new_figure(height_in=5.0, width_in=6.5)
    axes = figure.add_subplot()
    for number, (name, side) in enumerate(score.by_category.items()):
        known = [(iou, value) for iou, value in zip(THESIS_IOUS, side.by_iou, strict=True) if value is not None]
        if known:
            label = f"{name}: {side.ap_thesis:.3f} in the mean" if side.ap_thesis is not None else name
            axes.plot(*zip(*known, strict=True), marker="o", markersize=4, color=f"C{number % 10}", label=label)
    axes.set_xlim(-0.02, 1.02)
    axes.set_ylim(0.0, 1.03)
    axes.set_xlabel("IoU from which an instance counts as found")
    axes.set_ylabel("average precision")
    axes.set_title(f"average precision over IoU, {score.images} images", fontsize=10)
    axes.grid(visible=True, linewidth=0.3)
    axes.legend(loc="lower left", fontsize=8)
    save_figure(figure, path)
