# SPDX-License-Identifier: Apache-2.0
"""The score of instance masks as text and as JSON."""

from collections.abc import Mapping
from dataclasses import asdict

from services.evaluation.instance_masks.average_precision import THESIS_IOUS, AveragePrecision, MaskPrecision
from services.evaluation.instance_masks.confusion import ClassConfusion
from services.evaluation.instance_masks.found import FoundRules, FoundScore
from services.evaluation.run.comparison import NOTHING, ComparisonRow
from services.evaluation.run.outcome import Report

MEAN = "mean"
_ROWS = (
    ("AP, IoU 0.50 to 0.95", "ap"),
    ("AP, IoU 0.50", "ap50"),
    ("AP, IoU 0.75", "ap75"),
    ("AP, small (below 32^2 px)", "ap_small"),
    ("AP, medium", "ap_medium"),
    ("AP, large (above 96^2 px)", "ap_large"),
    ("AP, IoU 0 to 1 in steps of 0.1", "ap_thesis"),
    ("average recall", "recall"),
)
_PRECISION_ASKED = 0.5


def mask_rows(score: MaskPrecision, found: Mapping[str, FoundScore], rules: FoundRules) -> list[ComparisonRow]:
    """One row a measure; the mean over the categories first, then each, in the order of `score.by_category`."""
    sides: list[AveragePrecision] = [score.mean, *score.by_category.values()]
    rows = [
        ComparisonRow("true instances", tuple(str(side.true_instances) for side in sides)),
        ComparisonRow("found instances", tuple(str(side.found_instances) for side in sides)),
    ]
    rows += [ComparisonRow(what, tuple(_number(getattr(side, name)) for side in sides)) for what, name in _ROWS]
    scores = [found[name] for name in score.by_category]
    counted = f"IoU {rules.minimum_iou:g}, {rules.minimum_height_px:g} px high, score {rules.minimum_score:g}"
    for what, values in (
        (f"precision ({counted})", [_number(item.precision) for item in scores]),
        (f"recall ({counted})", [_number(item.recall) for item in scores]),
        ("  found / wrong / missed", [_counts(item) for item in scores]),
        (f"highest recall at precision {_PRECISION_ASKED:g}", [_number(item.recall_at(0.5)) for item in scores]),
    ):
        rows.append(ComparisonRow(what, (NOTHING, *values)))
    return rows


def describe_masks(
    score: MaskPrecision, found: Mapping[str, FoundScore], confusion: ClassConfusion, rules: FoundRules
) -> Report:
    """All of it for JSON; null where the truth has no such instance."""
    true, seen = [*confusion.names, "nothing"], [*confusion.names, "missed"]
    return {
        "images": score.images,
        "mean": _describe(score.mean),
        "by_category": {
            name: _describe(side) | _describe_found(found[name]) for name, side in score.by_category.items()
        },
        "confusion": {
            name: dict(zip(seen, row.tolist(), strict=True)) for name, row in zip(true, confusion.counts, strict=True)
        },
        "rules": asdict(rules),
    }


def _describe(side: AveragePrecision) -> Report:
    by_iou = {f"{iou:.1f}": value for iou, value in zip(THESIS_IOUS, side.by_iou, strict=True)}
    return {**asdict(side), "by_iou": by_iou}


def _describe_found(score: FoundScore) -> Report:
    return {
        "true_positives": score.true_positives,
        "false_positives": score.false_positives,
        "false_negatives": score.false_negatives,
        "precision": score.precision,
        "recall_at_score": score.recall,
        "recall_at_precision_0.5": score.recall_at(_PRECISION_ASKED),
    }


def _counts(score: FoundScore) -> str:
    return f"{score.true_positives} / {score.false_positives} / {score.false_negatives}"


def _number(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3f}"
