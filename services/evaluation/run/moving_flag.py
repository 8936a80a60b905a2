# SPDX-License-Identifier: Apache-2.0
"""How often the moving flag is right, counted per object and frame against the simulator's truth."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from schemas.records import MotionState, Objects, TrueInstances, TrueObject
from services.runtime.errors import InputError


@dataclass(frozen=True)
class MovingFlagRules:
    """Which object-frames count; one between `standing_m_s` and `moving_m_s` is neither and counts for nothing."""

    minimum_height_px: float = 40.0
    moving_m_s: float = 1.0
    standing_m_s: float = 0.1
    minimum_iou: float = 0.5


@dataclass
class MovingFlagScore:
    """Counts of object-frames. Positive: the estimate says `moving`; undecided is not `moving`."""

    true_positives: int = 0
    false_positives: int = 0
    false_negatives: int = 0
    true_negatives: int = 0
    missed: int = 0
    """of the false negatives, those whose object the estimate did not have at all"""
    unfounded: int = 0
    """of the false positives, those where no true object is"""
    frames: int = 0

    @property
    def precision(self) -> float | None:
        """None where nothing was ever called moving."""
        claimed = self.true_positives + self.false_positives
        return self.true_positives / claimed if claimed else None

    @property
    def recall(self) -> float | None:
        """None where nothing ever moved."""
        moving = self.true_positives + self.false_negatives
        return self.true_positives / moving if moving else None

    @property
    def f1(self) -> float | None:
        """None where nothing moved and nothing was called moving; 0 where only one of the two is so."""
        total = 2 * self.true_positives + self.false_positives + self.false_negatives
        return 2 * self.true_positives / total if total else None


class MovingFlagEvaluator:
    """Adds up a `MovingFlagScore` frame by frame; true and estimated objects are matched by mask IoU, optimally."""

    def __init__(self, rules: MovingFlagRules | None = None) -> None:
        self.rules = rules or MovingFlagRules()
        self.score = MovingFlagScore()

    def add(self, truth: TrueInstances, estimate: Objects) -> None:
        """Count one frame. Raises InputError where the two are not of the same time or image size."""
        if truth.timestamp_ns != estimate.timestamp_ns:
            raise InputError(
                f"objects of {estimate.timestamp_ns} ns, expected those of the truth's {truth.timestamp_ns} ns"
            )
        if truth.labels.shape != estimate.track_image.shape:
            raise InputError(
                f"track image of {estimate.track_image.shape}, expected {truth.labels.shape} as in the truth"
            )
        self.score.frames += 1
        moving_ids = {o.object_id for o in estimate.objects if o.motion_state is MotionState.MOVING}
        true_ids = [o.instance_id for o in truth.objects]
        estimated_ids = [o.object_id for o in estimate.objects]
        iou = mask_iou(truth.labels, true_ids, estimate.track_image, estimated_ids)
        rows, columns = linear_sum_assignment(iou, maximize=True)
        matched = {
            true_ids[row]: estimated_ids[column]
            for row, column in zip(rows, columns, strict=True)
            if iou[row, column] >= self.rules.minimum_iou
        }
        for true_object in truth.objects:
            self._count(true_object, matched.get(true_object.instance_id), moving_ids)
        founded = set(matched.values())
        tall = {o.object_id for o in estimate.objects if o.box_px[3] >= self.rules.minimum_height_px}
        unfounded = len((moving_ids & tall) - founded)
        self.score.unfounded += unfounded
        self.score.false_positives += unfounded

    def _count(self, true_object: TrueObject, object_id: int | None, moving_ids: set[int]) -> None:
        if true_object.box_px[3] < self.rules.minimum_height_px:
            return
        speed_m_s = float(np.linalg.norm(true_object.velocity_m_s))
        called_moving = object_id in moving_ids
        if speed_m_s >= self.rules.moving_m_s:
            self.score.true_positives += called_moving
            self.score.false_negatives += not called_moving
            self.score.missed += object_id is None
        elif speed_m_s < self.rules.standing_m_s and object_id is not None:
            self.score.false_positives += called_moving
            self.score.true_negatives += not called_moving


def mask_iou(
    first: npt.NDArray[np.uint32], first_ids: list[int], second: npt.NDArray[np.uint32], second_ids: list[int]
) -> npt.NDArray[np.float64]:
    """Intersection over union of every pair of masks of two label images (H, W): (len(first_ids), len(second_ids))."""
    iou = np.zeros((len(first_ids), len(second_ids)))
    if not first_ids or not second_ids:
        return iou
    first_area = {int(i): int(n) for i, n in zip(*np.unique(first, return_counts=True), strict=True)}
    second_area = {int(i): int(n) for i, n in zip(*np.unique(second, return_counts=True), strict=True)}
    both = (first != 0) & (second != 0)
    pairs = (first[both].astype(np.uint64) << np.uint64(32)) | second[both].astype(np.uint64)
    row_of = {instance_id: row for row, instance_id in enumerate(first_ids)}
    column_of = {instance_id: column for column, instance_id in enumerate(second_ids)}
    for pair, overlap in zip(*np.unique(pairs, return_counts=True), strict=True):
        first_id, second_id = int(pair) >> 32, int(pair) & 0xFFFFFFFF
        if first_id in row_of and second_id in column_of:
            union = first_area[first_id] + second_area[second_id] - int(overlap)
            iou[row_of[first_id], column_of[second_id]] = int(overlap) / union
    return iou
