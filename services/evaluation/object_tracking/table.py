# SPDX-License-Identifier: Apache-2.0
"""The score of object tracking as text and as JSON."""

from collections.abc import Mapping
from dataclasses import asdict

from services.evaluation.object_tracking.metrics import HOTA_IOUS, TrackingScore
from services.evaluation.object_tracking.score import ClassScore
from services.evaluation.run.comparison import ComparisonRow
from services.evaluation.run.outcome import Report

_SHARES = (
    ("HOTA", "hota"),
    ("DetA", "det_a"),
    ("AssA", "ass_a"),
    ("LocA", "loc_a"),
    ("MOTA", "mota"),
    ("MOTP", "motp"),
    ("IDF1", "idf1"),
)
_COUNTS = (
    ("true objects", "true_objects"),
    ("true objects in frames", "true_detections"),
    ("id switches", "id_switches"),
    ("false positives", "false_positives"),
    ("false negatives", "false_negatives"),
    ("fragmentations", "fragmentations"),
    ("mostly tracked", "mostly_tracked"),
    ("mostly lost", "mostly_lost"),
)


def tracking_rows(scores: Mapping[str, ClassScore]) -> list[ComparisonRow]:
    """One row a measure, one value a class; where there are several sequences, HOTA in each."""
    totals = [score.total for score in scores.values()]
    rows = [ComparisonRow(what, tuple(f"{getattr(side, name):.3f}" for side in totals)) for what, name in _SHARES]
    rows += [ComparisonRow(what, tuple(str(getattr(side, name)) for side in totals)) for what, name in _COUNTS]
    names = list(next(iter(scores.values())).by_sequence)
    if len(names) > 1:
        for name in names:
            rows.append(ComparisonRow(f"HOTA in {name}", tuple(_hota(s.by_sequence[name]) for s in scores.values())))
    return rows


def describe_tracking(scores: Mapping[str, ClassScore]) -> Report:
    """All of it for JSON."""
    return {
        "iou": HOTA_IOUS,
        "by_class": {
            category: {
                **asdict(score.total),
                "by_sequence": {name: asdict(alone) for name, alone in score.by_sequence.items()},
            }
            for category, score in scores.items()
        },
    }


def _hota(score: TrackingScore) -> str:
    return f"{score.hota:.3f}" if score.true_detections else "-"
