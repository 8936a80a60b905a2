# SPDX-License-Identifier: Apache-2.0
"""Precision and recall of instance masks at one IoU, for objects tall enough to matter."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from services.evaluation.instance_masks.average_precision import MOST_PER_IMAGE, coco_evaluator, run_quietly
from services.evaluation.progress import Progress, silent
from services.formats.coco import CocoDataset, CocoResult


@dataclass(frozen=True)
class FoundRules:
    """What counts: an object is found at `minimum_iou`; smaller ones are neither missed nor wrong."""

    minimum_iou: float = 0.5
    minimum_height_px: float = 40.0
    minimum_score: float = 0.3


@dataclass(frozen=True)
class FoundScore:
    """Counts of one category at `minimum_score`, and what they are at every other score.

    `scores`, falling, with `precisions` and `recalls` where everything down to that score counts; all (N,).
    """

    true_positives: int
    false_positives: int
    false_negatives: int
    scores: npt.NDArray[np.float64]
    precisions: npt.NDArray[np.float64]
    recalls: npt.NDArray[np.float64]

    @property
    def precision(self) -> float | None:
        """None where nothing was found."""
        claimed = self.true_positives + self.false_positives
        return self.true_positives / claimed if claimed else None

    @property
    def recall(self) -> float | None:
        """None where there is nothing to find."""
        true = self.true_positives + self.false_negatives
        return self.true_positives / true if true else None

    def recall_at(self, precision: float) -> float | None:
        """The highest recall at a precision of at least this; 0 where none is, None where there is nothing to find."""
        if self.recall is None:
            return None
        return float(self.recalls[self.precisions >= precision].max(initial=0.0))


def found_scores(
    truth: CocoDataset,
    found: Sequence[CocoResult],
    category_ids: Sequence[int],
    rules: FoundRules | None = None,
    progress: Progress = silent,
) -> dict[str, FoundScore]:
    """The score of every category asked for, by name.

    Matched as pycocotools does: the surest first, each to the free true mask that it covers best.
    """
    rules = rules or FoundRules()
    evaluator = coco_evaluator(truth, found, category_ids)
    measure_by_height(evaluator, rules)
    evaluator.params.maxDets = [MOST_PER_IMAGE]
    run_quietly(evaluator, progress, "counting what was found")
    images = len(evaluator.params.imgIds)
    names = {category.category_id: category.name for category in truth.categories}
    return {
        names[number]: _score(evaluator.evalImgs[place * images : (place + 1) * images], rules.minimum_score)
        for place, number in enumerate(evaluator.params.catIds)
    }


def measure_by_height(evaluator: Any, rules: FoundRules) -> None:
    """Let pycocotools, which passes over instances by their area, do so by their height, at one IoU."""
    for side in (evaluator.cocoGt, evaluator.cocoDt):
        for row in side.anns.values():
            row["area"] = row["bbox"][3]
    evaluator.params.iouThrs = np.array([rules.minimum_iou])
    evaluator.params.areaRng = [[rules.minimum_height_px, np.inf]]
    evaluator.params.areaRngLbl = ["tall"]


def _score(images: Sequence[dict[str, npt.NDArray[np.float64]] | None], minimum_score: float) -> FoundScore:
    seen = [image for image in images if image is not None]
    true = sum(int(np.sum(image["gtIgnore"] == 0)) for image in seen)
    counts = [image["dtIgnore"][0] == 0 for image in seen]
    scores = np.concatenate([np.array(i["dtScores"])[c] for i, c in zip(seen, counts, strict=True)] or [np.zeros(0)])
    right = np.concatenate([i["dtMatches"][0][c] > 0 for i, c in zip(seen, counts, strict=True)] or [np.zeros(0)])
    order = np.argsort(-scores, kind="stable")
    scores, right = scores[order], right[order].astype(bool)
    hits = np.cumsum(right)
    # equal scores are in or out together
    last = np.append(np.flatnonzero(np.diff(scores)), scores.size - 1) if scores.size else np.zeros(0, dtype=np.int64)
    kept = int(np.sum(scores >= minimum_score))
    true_positives = int(hits[kept - 1]) if kept else 0
    return FoundScore(
        true_positives=true_positives,
        false_positives=kept - true_positives,
        false_negatives=true - true_positives,
        scores=scores[last],
        precisions=hits[last] / (last + 1),
        recalls=hits[last] / true if true else np.zeros(last.size),
    )
