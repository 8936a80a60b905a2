# SPDX-License-Identifier: Apache-2.0
"""What instances of each category are taken for."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.evaluation.instance_masks.average_precision import MOST_PER_IMAGE, coco_evaluator, run_quietly
from services.evaluation.instance_masks.found import FoundRules, measure_by_height
from services.evaluation.progress import Progress, silent
from services.formats.coco import CocoDataset, CocoResult


@dataclass(frozen=True)
class ClassConfusion:
    """`counts` is (N + 1, N + 1), [true, found] over `names`; the last row is nothing there, the last column missed."""

    names: tuple[str, ...]
    counts: npt.NDArray[np.int64]


def class_confusion(
    truth: CocoDataset, found: Sequence[CocoResult], rules: FoundRules | None = None, progress: Progress = silent
) -> ClassConfusion:
    """Match instances by their masks alone, of all categories that were true or found, and count the pairs.

    The surest is matched first, to the free true mask that it covers best, as pycocotools does with `useCats` off.
    """
    rules = rules or FoundRules()
    sure = [result for result in found if result.score >= rules.minimum_score]
    seen = {item.category_id for item in truth.annotations} | {item.category_id for item in sure}
    categories = [category for category in truth.categories if category.category_id in seen]
    evaluator = coco_evaluator(truth, sure, sorted(seen))
    measure_by_height(evaluator, rules)
    evaluator.params.useCats = 0
    evaluator.params.maxDets = [MOST_PER_IMAGE]
    run_quietly(evaluator, progress, "counting confusions")
    place = {category.category_id: number for number, category in enumerate(categories)}
    counts = np.zeros((len(categories) + 1, len(categories) + 1), dtype=np.int64)
    true_of, found_of = (
        {number: place[row["category_id"]] for number, row in side.anns.items()}
        for side in (evaluator.cocoGt, evaluator.cocoDt)
    )
    for image in evaluator.evalImgs:
        if image is None:
            continue
        matched = image["dtMatches"][0].astype(np.int64).tolist()
        for number, true, ignored in zip(image["dtIds"], matched, image["dtIgnore"][0], strict=True):
            if not ignored:
                counts[true_of[true] if true else -1, found_of[number]] += 1
        free = (image["gtMatches"][0] == 0) & (image["gtIgnore"] == 0)
        for number in np.array(image["gtIds"], dtype=np.int64)[free]:
            counts[true_of[int(number)], -1] += 1
    return ClassConfusion(tuple(category.name for category in categories), counts)
