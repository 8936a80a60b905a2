# SPDX-License-Identifier: Apache-2.0
"""HOTA and its two parts over IoU, and by sequence."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from services.evaluation.object_tracking.metrics import HOTA_IOUS
from services.evaluation.object_tracking.score import ClassScore
from services.evaluation.pictures.figure import new_figure, save_figure, shown_name

_PARTS = (("HOTA", "hota", "#1f77b4"), ("DetA", "det_a", "#2e8b57"), ("AssA", "ass_a", "#d62728"))


def plot_hota_by_iou(scores: Mapping[str, ClassScore], path: Path) -> None:
    """One picture a class: finding objects (DetA) and keeping their ids (AssA), the stricter the farther right."""
    figure = new_figure(height_in=4.2, width_in=5.0 * len(scores))
    for axes, (category, score) in zip(figure.subplots(1, len(scores), squeeze=False)[0], scores.items(), strict=True):
        for name, field, colour in _PARTS:
            values = getattr(score.total, f"{field}_by_iou")
            label = f"{name}: {getattr(score.total, field):.3f}"
            axes.plot(
                HOTA_IOUS, values, marker=".", color=colour, linewidth=2.0 if name == "HOTA" else 1.0, label=label
            )
        axes.set_xlim(0.0, 1.0)
        axes.set_ylim(0.0, 1.03)
        axes.set_xlabel("IoU from which an object counts as found")
        axes.set_ylabel("score, 0 to 1")
        true = f"{score.total.true_objects} objects in {score.total.true_detections} views"
        axes.set_title(f"{shown_name(category)}: {true}")
        axes.grid(visible=True, linewidth=0.3)
        axes.legend(loc="lower left", fontsize=8)
    save_figure(figure, path)


def plot_sequences(scores: Mapping[str, ClassScore], path: Path) -> None:
    """HOTA, DetA and AssA of every sequence; a sequence without a true object of the class has no bars."""
    figure = new_figure(height_in=0.4 + 2.8 * len(scores))
    for axes, (category, score) in zip(
        figure.subplots(len(scores), 1, squeeze=False)[:, 0], scores.items(), strict=True
    ):
        known = {name: alone for name, alone in score.by_sequence.items() if alone.true_detections}
        places = np.arange(len(known))
        for number, (name, field, colour) in enumerate(_PARTS):
            values = [getattr(alone, field) for alone in known.values()]
            axes.bar(places + 0.27 * (number - 1), values, width=0.25, color=colour, label=name)
        axes.set_xticks(places, [*map(shown_name, known)])
        axes.set_ylim(0.0, 1.03)
        axes.set_title(f"{shown_name(category)}, by sequence")
        axes.set_ylabel("score, 0 to 1")
        axes.grid(visible=True, axis="y", linewidth=0.3)
        axes.set_axisbelow(True)
        axes.legend(loc="upper right", fontsize=8, ncols=3)
    save_figure(figure, path)
