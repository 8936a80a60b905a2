# SPDX-License-Identifier: Apache-2.0
"""Figure 5.1 of the thesis: average precision of a segmenter's cars on KITTI, and its time for all images."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from schemas.categories import category_id
from services.evaluation.bench.table import NOTHING, BenchTable
from services.evaluation.instance_masks.average_precision import (
    THESIS_IOUS,
    AveragePrecision,
    MaskPrecision,
    mask_precision,
)
from services.evaluation.progress import Progress, silent
from services.evaluation.run.outcome import Report
from services.evaluation.thesis.published import THESIS_GAIN_PERCENT, THESIS_SEGMENTERS
from services.formats.coco import CocoAnnotation, CocoCategory, CocoDataset, CocoImage, CocoResult


@dataclass(frozen=True)
class SegmenterScore:
    """One segmenter on all images. `seconds` is the time it took to segment them; None where it only read files.

    `skipped` images are those that it had no word about: whatever is in them was missed.
    """

    name: str
    precision: AveragePrecision
    images: int
    seconds: float | None
    skipped: int


def score_segmenter(
    name: str,
    images: Sequence[CocoImage],
    truth: Sequence[CocoAnnotation],
    found: Sequence[CocoResult],
    category: str,
    *,
    seconds: float | None,
    skipped: int = 0,
    progress: Progress = silent,
) -> SegmenterScore:
    """Score one category. Raises InputError where there is no true instance of it."""
    number = category_id(category)
    dataset = CocoDataset(tuple(images), (CocoCategory(number, category),), tuple(truth))
    result = mask_precision(dataset, found, [number], progress)
    return SegmenterScore(name, result.by_category[category], len(images), seconds, skipped)


def side_by_side(scores: Sequence[SegmenterScore]) -> MaskPrecision:
    """The segmenters in the place of categories, for the picture of precision by IoU."""
    return MaskPrecision(scores[0].precision, {score.name: score.precision for score in scores}, scores[0].images)


def gain_percent(score: SegmenterScore, baseline: SegmenterScore) -> float | None:
    """By how much the AP over IoU 0 to 1 is above the baseline's, in percent of it; None without either."""
    mine, theirs = score.precision.ap_thesis, baseline.precision.ap_thesis
    return 100.0 * (mine / theirs - 1.0) if mine is not None and theirs else None


def instances_table(scores: Sequence[SegmenterScore], category: str) -> BenchTable:
    """A row a segmenter, the first being what the others are compared with; then the thesis' two."""
    header = (
        "segmenter",
        f"AP of {category}, IoU 0 to 1 by 0.1",
        "gain on the first [%]",
        "AP, IoU 0.50 to 0.95",
        "AP50",
        "AP75",
        "true / found",
        "images",
        "seconds",
        "seconds an image",
    )
    rows = []
    for number, score in enumerate(scores):
        side = score.precision
        gain = gain_percent(score, scores[0]) if number else None
        each = None if score.seconds is None else score.seconds / score.images
        rows.append(
            (
                score.name,
                _number(side.ap_thesis),
                NOTHING if gain is None else f"{gain:+.2f}",
                _number(side.ap),
                _number(side.ap50),
                _number(side.ap75),
                f"{side.true_instances} / {side.found_instances}",
                f"{score.images}" + (f" ({score.skipped} without a word)" if score.skipped else ""),
                _number(score.seconds, 2),
                _number(each),
            )
        )
    for place, published in enumerate(THESIS_SEGMENTERS):
        gain_cell = f"{THESIS_GAIN_PERCENT:+.2f}" if place else NOTHING
        cells = (NOTHING, gain_cell, NOTHING, NOTHING, NOTHING, NOTHING, "200", f"{published.seconds:.2f}")
        rows.append((f"thesis, {published.name}", *cells, f"{published.seconds / 200:.3f}"))
    return BenchTable(header, tuple(rows))


def describe_instances(scores: Sequence[SegmenterScore], category: str, min_score: float) -> Report:
    """All of it for JSON."""
    return {
        "category": category,
        "min_score": min_score,
        "thesis": {
            "seconds": {published.name: published.seconds for published in THESIS_SEGMENTERS},
            "gain_percent": THESIS_GAIN_PERCENT,
        },
        "segmenters": [
            {
                **asdict(score),
                "precision": {
                    **asdict(score.precision),
                    "by_iou": {f"{iou:.1f}": ap for iou, ap in zip(THESIS_IOUS, score.precision.by_iou, strict=True)},
                },
                "gain_percent": gain_percent(score, scores[0]) if number else None,
            }
            for number, score in enumerate(scores)
        ],
    }


def _number(value: float | None, digits: int = 3) -> str:
    return NOTHING if value is None else f"{value:.{digits}f}"
