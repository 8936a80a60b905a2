# SPDX-License-Identifier: Apache-2.0
"""A mask cut out at its box: what is remembered of an object's shape."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

BoxPx = tuple[float, float, float, float]
"""x, y, width, height"""


@dataclass(frozen=True)
class MaskPatch:
    """A boolean mask (height, width) whose upper left pixel lies at column `x`, row `y`, in the image or outside it."""

    x: int
    y: int
    mask: npt.NDArray[np.bool_]

    @property
    def area_px(self) -> int:
        """Pixels of the mask."""
        return int(np.count_nonzero(self.mask))

    def fitted(self, box_px: BoxPx) -> "MaskPatch":
        """The same shape stretched into another box."""
        width, height = max(1, round(box_px[2])), max(1, round(box_px[3]))
        mask = self.mask
        if mask.shape != (height, width):
            mask = cv2.resize(mask.astype(np.uint8), (width, height), interpolation=cv2.INTER_NEAREST) > 0
        return MaskPatch(round(box_px[0]), round(box_px[1]), mask)


def cut_out(labels: npt.NDArray[np.uint32], instance_id: int, box_px: BoxPx) -> MaskPatch:
    """The mask of `instance_id` inside its box in the label image (H, W)."""
    x, y = max(0, int(box_px[0])), max(0, int(box_px[1]))
    right, bottom = int(np.ceil(box_px[0] + box_px[2])), int(np.ceil(box_px[1] + box_px[3]))
    return MaskPatch(x, y, labels[y:bottom, x:right] == instance_id)


def mask_iou(first: MaskPatch, second: MaskPatch) -> float:
    """Intersection over union of two masks of one image; 0 where both are empty."""
    left, top = max(first.x, second.x), max(first.y, second.y)
    right = min(first.x + first.mask.shape[1], second.x + second.mask.shape[1])
    bottom = min(first.y + first.mask.shape[0], second.y + second.mask.shape[0])
    if right <= left or bottom <= top:
        return 0.0
    overlap = int(
        np.count_nonzero(
            first.mask[top - first.y : bottom - first.y, left - first.x : right - first.x]
            & second.mask[top - second.y : bottom - second.y, left - second.x : right - second.x]
        )
    )
    union = first.area_px + second.area_px - overlap
    return overlap / union if union else 0.0
