# SPDX-License-Identifier: Apache-2.0
"""Which instance of this image is which object of before."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from services.tracker.mask_patch import BoxPx, MaskPatch, mask_iou

ALIKE = (("car", "truck", "bus", "train"), ("bicycle", "motorcycle"))
"""categories that a segmenter takes for each other from one image to the next"""


@dataclass(frozen=True)
class AssociationOptions:
    """When two masks may be of one object."""

    least_iou: float = 0.15
    largest_distance: float = 1.0
    """between centres, in the larger box's mean side, where the masks do not overlap (thin people, few frames)"""
    distance_slack_px: float = 4.0
    """more that the smallest objects may jump"""
    largest_size_ratio: float = 1.6


@dataclass(frozen=True)
class Candidate:
    """One side of a match: a category with its mask in this image, found or predicted."""

    category: str
    patch: MaskPatch
    box_px: BoxPx


def same_class(first: str, second: str) -> bool:
    """Whether an instance of one category may be an object of the other."""
    return first == second or any(first in group and second in group for group in ALIKE)


def associate(
    predicted: Sequence[Candidate], found: Sequence[Candidate], options: AssociationOptions | None = None
) -> list[tuple[int, int]]:
    """Pairs (index in predicted, index in found), optimal in the sum of mask IoU (Kuhn-Munkres).

    What overlaps is matched first; what is left is matched by the distance of centres among boxes of like size.
    """
    options = options or AssociationOptions()
    overlap = _scores(predicted, found, lambda a, b: _overlap(a, b, options))
    pairs = _assign(overlap)
    rows = [row for row in range(len(predicted)) if row not in {pair[0] for pair in pairs}]
    columns = [column for column in range(len(found)) if column not in {pair[1] for pair in pairs}]
    nearness = _scores(
        [predicted[row] for row in rows], [found[column] for column in columns], lambda a, b: _nearness(a, b, options)
    )
    pairs += [(rows[row], columns[column]) for row, column in _assign(nearness)]
    return sorted(pairs)


def _scores(
    predicted: Sequence[Candidate], found: Sequence[Candidate], score: Callable[[Candidate, Candidate], float]
) -> npt.NDArray[np.float64]:
    scores = np.zeros((len(predicted), len(found)))
    for row, before in enumerate(predicted):
        for column, now in enumerate(found):
            if same_class(before.category, now.category):
                scores[row, column] = score(before, now)
    return scores


def _assign(scores: npt.NDArray[np.float64]) -> list[tuple[int, int]]:
    """The assignment of the largest sum; pairs that score zero are none."""
    if not scores.size:
        return []
    rows, columns = linear_sum_assignment(scores, maximize=True)
    return [(int(row), int(column)) for row, column in zip(rows, columns, strict=True) if scores[row, column] > 0.0]


def _overlap(before: Candidate, now: Candidate, options: AssociationOptions) -> float:
    if _apart(before.patch, now.patch):
        return 0.0
    iou = mask_iou(before.patch, now.patch)
    return iou if iou >= options.least_iou else 0.0


def _apart(first: MaskPatch, second: MaskPatch) -> bool:
    (first_height, first_width), (second_height, second_width) = first.mask.shape, second.mask.shape
    aside = first.x >= second.x + second_width or second.x >= first.x + first_width
    return bool(aside or first.y >= second.y + second_height or second.y >= first.y + first_height)


def _nearness(before: Candidate, now: Candidate, options: AssociationOptions) -> float:
    sides = [np.sqrt(max(1.0, box[2] * box[3])) for box in (before.box_px, now.box_px)]
    if max(sides) > options.largest_size_ratio * min(sides):
        return 0.0
    away = np.hypot(*(_centre(now.box_px) - _centre(before.box_px))) / (
        options.largest_distance * max(sides) + options.distance_slack_px
    )
    return float(max(0.0, 1.0 - away))


def _centre(box_px: BoxPx) -> npt.NDArray[np.float64]:
    return np.array([box_px[0] + 0.5 * box_px[2], box_px[1] + 0.5 * box_px[3]])
