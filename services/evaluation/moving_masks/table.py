# SPDX-License-Identifier: Apache-2.0
"""The score of moving masks as text and as JSON."""

from dataclasses import asdict

import numpy as np

from services.evaluation.moving_masks.iou import MaskClass, MovingMaskScore
from services.evaluation.moving_masks.score import FlagRules, MovingMaskResult
from services.evaluation.run.comparison import NOTHING, ComparisonRow
from services.evaluation.run.outcome import Report

_NAMES = {MaskClass.BACKGROUND: "background", MaskClass.NON_MOVING: "non-moving", MaskClass.MOVING: "moving"}


def class_names(score: MovingMaskScore) -> dict[MaskClass, str]:
    """What to call the classes that the masks know."""
    return {**_NAMES, MaskClass.BACKGROUND: "everything else"} if score.binary else _NAMES


def moving_rows(result: MovingMaskResult, rules: FlagRules) -> list[ComparisonRow]:
    """One row a measure; a dash where nothing of the kind is there."""
    total = result.total
    names = class_names(total)
    rows = [("frames", str(len(result.by_frame)))]
    rows += [(f"IoU, {names[kind]}", _number(total.iou(kind))) for kind in reversed(total.classes)]
    rows += [
        ("IoU, mean of the classes", _number(total.mean_iou)),
        ("IoU, moving, median of the frames", _number(_median_iou(result))),
        ("precision of moving pixels", _number(total.precision)),
        ("recall of moving pixels", _number(total.recall)),
    ]
    if result.flag is not None:
        flag = result.flag
        rows += [
            (f"precision of the flag, {rules.minimum_height_px:g} px high and more", _number(flag.precision)),
            ("recall of the flag", _number(flag.recall)),
            ("F1 of the flag", _number(flag.f1)),
            ("  right / wrong / missed", f"{flag.true_positives} / {flag.false_positives} / {flag.false_negatives}"),
        ]
    return [ComparisonRow(what, (value,)) for what, value in rows]


def describe_moving(result: MovingMaskResult, rules: FlagRules) -> Report:
    """All of it for JSON; null where nothing of the kind is there."""
    flag = result.flag
    return {
        **_describe(result.total),
        "pixels": {
            _NAMES[true]: {_NAMES[seen]: int(result.total.confusion[true, seen]) for seen in result.total.classes}
            for true in result.total.classes
        },
        "precision": result.total.precision,
        "recall": result.total.recall,
        "flag": None
        if flag is None
        else {
            **asdict(flag),
            "precision": flag.precision,
            "recall": flag.recall,
            "f1": flag.f1,
            "rules": asdict(rules),
        },
        "by_frame": {frame: _describe(score) for frame, score in result.by_frame.items()},
        "missing": result.missing,
        "without_truth": result.without_truth,
    }


def _describe(score: MovingMaskScore) -> Report:
    return {"iou": {_NAMES[kind]: score.iou(kind) for kind in score.classes}, "mean_iou": score.mean_iou}


def _median_iou(result: MovingMaskResult) -> float | None:
    known = [iou for score in result.by_frame.values() if (iou := score.iou(MaskClass.MOVING)) is not None]
    return float(np.median(known)) if known else None


def _number(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.3f}"
