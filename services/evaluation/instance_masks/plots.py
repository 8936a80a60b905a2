# SPDX-License-Identifier: Apache-2.0
"""Precision over recall of every category, and its average precision over IoU."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from services.evaluation.instance_masks.average_precision import THESIS_IOUS, MaskPrecision
from services.evaluation.instance_masks.confusion import ClassConfusion
from services.evaluation.instance_masks.found import FoundRules, FoundScore
from services.evaluation.pictures.figure import new_figure, save_figure, shown_name

_DARK = 0.6


def plot_precision_recall(found: Mapping[str, FoundScore], rules: FoundRules, path: Path) -> None:
    """One curve a category, from the surest instances to all; the dot is where `minimum_score` stands."""
    figure = new_figure(height_in=5.5, width_in=6.5)
    axes = figure.add_subplot()
    for number, (name, score) in enumerate(found.items()):
        if score.recall is None:
            continue
        colour = f"C{number % 10}"
        axes.plot(score.recalls, score.precisions, color=colour, label=shown_name(name), drawstyle="steps-pre")
        if score.precision is not None:
            axes.plot([score.recall], [score.precision], marker="o", color=colour)
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, 1.03)
    axes.set_xlabel("recall")
    axes.set_ylabel("precision")
    axes.set_title(
        f"precision over recall: IoU {rules.minimum_iou:g}, {rules.minimum_height_px:g} px high and more;"
        f" dot: score {rules.minimum_score:g}",
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
            mean = "" if side.ap_thesis is None else f": {side.ap_thesis:.3f} in the mean"
            label = f"{shown_name(name)}{mean}"
            axes.plot(*zip(*known, strict=True), marker="o", markersize=4, color=f"C{number % 10}", label=label)
    axes.set_xlim(-0.02, 1.02)
    axes.set_ylim(0.0, 1.03)
    axes.set_xlabel("IoU from which an instance counts as found")
    axes.set_ylabel("average precision")
    axes.set_title(f"average precision over IoU, {score.images} images", fontsize=10)
    axes.grid(visible=True, linewidth=0.3)
    if axes.lines:
        axes.legend(loc="lower left", fontsize=8)
    save_figure(figure, path)


def plot_class_confusion(confusion: ClassConfusion, path: Path) -> None:
    """Counts of true and found categories; a row's colour is its share of the true instances."""
    names, size = [*map(shown_name, confusion.names)], len(confusion.names) + 1
    share = confusion.counts / np.maximum(confusion.counts.sum(axis=1, keepdims=True), 1)
    side_in = 2.2 + 0.65 * size
    figure = new_figure(height_in=side_in, width_in=side_in + 0.6)
    axes = figure.add_subplot()
    axes.imshow(share, cmap="Blues", vmin=0.0, vmax=1.0)
    for row, column in np.argwhere(confusion.counts > 0).tolist():
        colour = "white" if share[row, column] > _DARK else "black"
        axes.text(column, row, str(confusion.counts[row, column]), ha="center", va="center", color=colour, fontsize=9)
    axes.set_xticks(range(size), [*names, "missed"], rotation=45, ha="right")
    axes.set_yticks(range(size), [*names, "nothing"])
    axes.set_title("instances that cover each other", fontsize=10)
    axes.set_xlabel("found")
    axes.set_ylabel("true")
    save_figure(figure, path)
