# SPDX-License-Identifier: Apache-2.0
"""Average precision of instance masks, by pycocotools, and its average over IoU 0 to 1 as in the thesis."""

import contextlib
import io
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from services.evaluation.progress import Progress, silent
from services.formats.coco import CocoDataset, CocoResult
from services.formats.rle import mask_area, mask_box
from services.runtime.errors import InputError, ResourceError

COCO_IOUS = np.linspace(0.5, 0.95, 10)
THESIS_IOUS = np.linspace(0.0, 1.0, 11)
MOST_PER_IMAGE = 100
_ALL, _SMALL, _MEDIUM, _LARGE = range(4)


@dataclass(frozen=True)
class AveragePrecision:
    """Of one category, or the mean over those that the truth has; None where the truth has no such instance.

    `ap` is the mean over IoU 0.50 to 0.95 in steps of 0.05 (COCO); small is below 32^2 px of area, large above 96^2.
    `ap_thesis` is the mean over IoU 0 to 1 in steps of 0.1 (thesis 4.2.2): an instance is found where its IoU is
    higher than the threshold, and at 1 where it is exact, as pycocotools has it. `recall` is COCO's average recall.
    """

    ap: float | None
    ap50: float | None
    ap75: float | None
    ap_small: float | None
    ap_medium: float | None
    ap_large: float | None
    ap_thesis: float | None
    recall: float | None
    true_instances: int
    found_instances: int
    by_iou: tuple[float | None, ...]
    """AP at each of THESIS_IOUS"""


@dataclass(frozen=True)
class MaskPrecision:
    """The mean over the categories, and each by name."""

    mean: AveragePrecision
    by_category: dict[str, AveragePrecision]
    images: int


def mask_precision(
    truth: CocoDataset, found: Sequence[CocoResult], category_ids: Sequence[int], progress: Progress = silent
) -> MaskPrecision:
    """Score the instances that were found on the images of `truth`, for the categories asked for.

    An image without any true instance counts what was found on it as wrong; a category without one is left out of
    the mean (as pycocotools does).

    Raises:
        InputError: no image, no category, or none of the categories has a true instance.
    """
    names = {category.category_id: category.name for category in truth.categories}
    counted = {number: sum(a.category_id == number and not a.is_crowd for a in truth.annotations) for number in names}
    if not truth.images or not any(counted[number] for number in category_ids):
        asked = ", ".join(names[number] for number in category_ids) or "any category"
        raise InputError(f"{len(truth.images)} images without a true instance of {asked}, expected at least one")
    evaluator = coco_evaluator(truth, found, category_ids)
    # just above each threshold but the last, which pycocotools itself lowers to 1 - 1e-10
    above = np.append(np.nextafter(THESIS_IOUS[:-1], 1.0), 1.0)
    evaluator.params.iouThrs = np.concatenate((COCO_IOUS, above))
    evaluator.params.maxDets = [MOST_PER_IMAGE]
    run_quietly(evaluator, progress, "matching masks")
    precision, recall = evaluator.eval["precision"][..., 0], evaluator.eval["recall"][..., 0]
    columns = {number: column for column, number in enumerate(evaluator.params.catIds)}
    found_count = {number: sum(result.category_id == number for result in found) for number in names}
    return MaskPrecision(
        mean=_summarize(
            precision, recall, sum(counted[i] for i in category_ids), sum(found_count[i] for i in category_ids)
        ),
        by_category={
            names[number]: _summarize(
                precision[:, :, [columns[number]]],
                recall[:, [columns[number]]],
                counted[number],
                found_count[number],
            )
            for number in category_ids
        },
        images=len(truth.images),
    )


def coco_evaluator(truth: CocoDataset, found: Sequence[CocoResult], category_ids: Sequence[int]) -> Any:
    """pycocotools' COCOeval on masks. Annotations are numbered from 1: it takes the id 0 for not matched."""
    try:
        from pycocotools.coco import COCO
        from pycocotools.cocoeval import COCOeval
    except ImportError:
        raise ResourceError("pycocotools is not installed, expected it for masks: pip install pycocotools") from None
    images = [{"id": image.image_id, "width": image.width, "height": image.height} for image in truth.images]
    categories = [{"id": category.category_id, "name": category.name} for category in truth.categories]
    true_rows = [
        {
            "id": number,
            "image_id": item.image_id,
            "category_id": item.category_id,
            "segmentation": item.mask.as_coco(),
            "area": item.area_px,
            "bbox": list(item.box_px),
            "iscrowd": int(item.is_crowd),
        }
        for number, item in enumerate(truth.annotations, start=1)
    ]
    found_rows = [
        {
            "id": number,
            "image_id": item.image_id,
            "category_id": item.category_id,
            "segmentation": item.mask.as_coco(),
            "area": float(mask_area(item.mask)),
            "bbox": list(mask_box(item.mask)),
            "iscrowd": 0,
            "score": item.score,
        }
        for number, item in enumerate(found, start=1)
    ]
    sides = []
    with contextlib.redirect_stdout(io.StringIO()):
        for rows in (true_rows, found_rows):
            side = COCO()
            side.dataset = {"images": images, "categories": categories, "annotations": rows}
            side.createIndex()
            sides.append(side)
        evaluator = COCOeval(*sides, iouType="segm")
    evaluator.params.catIds = sorted(category_ids)
    return evaluator


def run_quietly(evaluator: Any, progress: Progress, what: str) -> None:
    """Evaluate and accumulate image by image, so that progress can be shown; pycocotools' prints are dropped."""
    matched, kept = [], []
    images = sorted(evaluator.params.imgIds)
    for image in progress(images, what):
        evaluator.params.imgIds = [image]
        with contextlib.redirect_stdout(io.StringIO()):
            evaluator.evaluate()
        matched.append(evaluator.evalImgs)
        kept.append(image)
    # pycocotools' order: by category, then by area, then by image
    evaluator.evalImgs = [rows[place] for place in range(len(matched[0])) for rows in matched]
    evaluator.params.imgIds = kept
    evaluator._paramsEval.imgIds = kept
    with contextlib.redirect_stdout(io.StringIO()):
        evaluator.accumulate()


def _summarize(
    precision: npt.NDArray[np.float64], recall: npt.NDArray[np.float64], true_instances: int, found_instances: int
) -> AveragePrecision:
    coco, thesis = precision[: len(COCO_IOUS)], precision[len(COCO_IOUS) :]
    return AveragePrecision(
        ap=_mean(coco[..., _ALL]),
        ap50=_mean(coco[0, ..., _ALL]),
        ap75=_mean(coco[5, ..., _ALL]),
        ap_small=_mean(coco[..., _SMALL]),
        ap_medium=_mean(coco[..., _MEDIUM]),
        ap_large=_mean(coco[..., _LARGE]),
        ap_thesis=_mean(thesis[..., _ALL]),
        recall=_mean(recall[: len(COCO_IOUS), :, _ALL]),
        true_instances=true_instances,
        found_instances=found_instances,
        by_iou=tuple(_mean(at_iou) for at_iou in thesis[..., _ALL]),
    )


def _mean(values: npt.NDArray[np.float64]) -> float | None:
    known = values[values > -1]  # -1: no true instance of this category and size
    return float(known.mean()) if known.size else None
