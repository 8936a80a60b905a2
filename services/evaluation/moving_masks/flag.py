# SPDX-License-Identifier: Apache-2.0
"""How often the moving flag of an instance is right, from label images that carry it."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from services.evaluation.run.moving_flag import MovingFlagScore, mask_iou
from services.formats.label_images import LabelledInstance
from services.runtime.errors import InputError


class LabelledFlagEvaluator:
    """Adds up a `MovingFlagScore` over frames whose true and found instances say whether they move.

    Matched by mask IoU, optimally, as `MovingFlagEvaluator` matches a session's. Instances lower than
    `minimum_height_px` count for nothing. A true instance that was not found at all is called moving by nobody.
    """

    def __init__(self, minimum_iou: float = 0.5, minimum_height_px: float = 40.0) -> None:
        self.score = MovingFlagScore()
        self._minimum_iou = minimum_iou
        self._minimum_height_px = minimum_height_px

    def add(
        self,
        truth: tuple[npt.NDArray[np.uint16], Sequence[LabelledInstance]],
        found: tuple[npt.NDArray[np.uint16], Sequence[LabelledInstance]],
    ) -> None:
        """Count one frame: label images (H, W) with what they show. Raises InputError for images of other sizes."""
        (true_labels, true_rows), (found_labels, found_rows) = truth, found
        if true_labels.shape != found_labels.shape:
            raise InputError(f"label image of {found_labels.shape}, expected {true_labels.shape} as in the truth")
        self.score.frames += 1
        iou = mask_iou(
            true_labels.astype(np.uint32),
            [row.label for row in true_rows],
            found_labels.astype(np.uint32),
            [row.label for row in found_rows],
        )
        rows, columns = linear_sum_assignment(iou, maximize=True)
        pairs = zip(rows.tolist(), columns.tolist(), strict=True)
        matched = {row: column for row, column in pairs if iou[row, column] >= self._minimum_iou}
        for place, true in enumerate(true_rows):
            if self._is_tall(true_labels, true):
                column = matched.get(place)
                self._count(bool(true.moving), None if column is None else found_rows[column])
        founded = set(matched.values())
        for place, row in enumerate(found_rows):
            if row.moving and place not in founded and self._is_tall(found_labels, row):
                self.score.unfounded += 1
                self.score.false_positives += 1

    def _count(self, moves: bool, found: LabelledInstance | None) -> None:
        called_moving = found is not None and bool(found.moving)
        if moves:
            self.score.true_positives += called_moving
            self.score.false_negatives += not called_moving
            self.score.missed += found is None
        elif found is not None:
            self.score.false_positives += called_moving
            self.score.true_negatives += not called_moving

    def _is_tall(self, labels: npt.NDArray[np.uint16], row: LabelledInstance) -> bool:
        lines = np.flatnonzero((labels == row.label).any(axis=1))
        return bool(lines.size) and int(lines[-1] - lines[0] + 1) >= self._minimum_height_px
