# SPDX-License-Identifier: Apache-2.0
"""IoU of what moves, of what could but stands, and of the background, over a whole data set."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError


class MaskClass(IntEnum):
    """The value of a pixel."""

    BACKGROUND = 0
    NON_MOVING = 1
    MOVING = 2


@dataclass(frozen=True)
class MovingMaskScore:
    """Pixels, counted: `confusion` is (3, 3), [true class, found class].

    An IoU is the sum of intersections over the sum of unions of all frames; the mean of the classes' is the mIoU of
    semantic segmentation (Long et al., CVPR 2015), by which the thesis judges stage 2 (5.1.2.1: 35 %).
    Where `binary`, the masks know moving and everything else alone: there is no class `NON_MOVING`.
    """

    confusion: npt.NDArray[np.int64]
    binary: bool = False

    @property
    def classes(self) -> tuple[MaskClass, ...]:
        """Those that the masks know."""
        return (MaskClass.BACKGROUND, MaskClass.MOVING) if self.binary else tuple(MaskClass)

    def as_binary(self) -> "MovingMaskScore":
        """The same pixels, those that stand counted as background."""
        folded = np.zeros((3, 3), dtype=np.int64)
        ends = np.ix_((MaskClass.BACKGROUND, MaskClass.MOVING), (MaskClass.BACKGROUND, MaskClass.MOVING))
        folded[ends] = np.add.reduceat(np.add.reduceat(self.confusion, (0, 2), axis=0), (0, 2), axis=1)
        return MovingMaskScore(folded, binary=True)

    def iou(self, mask_class: MaskClass) -> float | None:
        """None where neither the truth nor the estimate has a pixel of the class."""
        both = int(self.confusion[mask_class, mask_class])
        union = int(self.confusion[mask_class].sum() + self.confusion[:, mask_class].sum()) - both
        return both / union if union else None

    @property
    def mean_iou(self) -> float | None:
        """Over the classes that there are; None without a pixel."""
        known = [iou for iou in map(self.iou, self.classes) if iou is not None]
        return float(np.mean(known)) if known else None

    @property
    def precision(self) -> float | None:
        """Of moving pixels; None where nothing was called moving."""
        return _share(self.confusion[MaskClass.MOVING, MaskClass.MOVING], self.confusion[:, MaskClass.MOVING].sum())

    @property
    def recall(self) -> float | None:
        """Of moving pixels; None where nothing moved."""
        return _share(self.confusion[MaskClass.MOVING, MaskClass.MOVING], self.confusion[MaskClass.MOVING].sum())


def compare_masks(frame: str, truth: npt.NDArray[np.uint8], found: npt.NDArray[np.uint8]) -> MovingMaskScore:
    """Count one frame's masks (H, W) of `MaskClass`. Raises InputError where they are of different sizes."""
    if truth.shape != found.shape:
        raise InputError(
            f"mask of frame {frame}: {found.shape[1]}x{found.shape[0]} px, "
            f"expected {truth.shape[1]}x{truth.shape[0]} as in the truth"
        )
    counts = np.bincount((truth * np.uint8(3) + found).ravel(), minlength=9)
    return MovingMaskScore(counts.reshape(3, 3).astype(np.int64))


def sum_of(scores: Iterable[MovingMaskScore], *, binary: bool = False) -> MovingMaskScore:
    """All frames as one."""
    confusion = sum((score.confusion for score in scores), np.zeros((3, 3), dtype=np.int64))
    score = MovingMaskScore(confusion)
    return score.as_binary() if binary else score


def _share(part: np.int64, whole: np.int64) -> float | None:
    return float(part / whole) if whole else None
