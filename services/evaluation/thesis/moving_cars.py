# SPDX-License-Identifier: Apache-2.0
"""From a mask of all cars, and boxes that say which of them move, to a mask of what moves (thesis 4.1.3)."""

from collections.abc import Sequence

import cv2
import numpy as np
import numpy.typing as npt

from services.evaluation.moving_masks.iou import MaskClass
from services.formats.kitti_moseg import MovingBox

COVERED = 0.5
"""share of a piece's pixels that a box has to cover to be its car's"""
_ANOTHER_CAR = 0.1
"""share of a piece outside of its box from which, where another box covers it, it is another car's"""

Piece = npt.NDArray[np.bool_]
Window = tuple[slice, slice]


def moving_cars(cars: npt.NDArray[np.uint8], boxes: Sequence[MovingBox]) -> npt.NDArray[np.uint8]:
    """The mask of `MaskClass` (H, W) of `cars` (H, W), 0 where there is none.

    A piece is a value of its own where the mask has several values, else an 8-connected part of it. A piece goes whole
    with one box: of those that cover at least half of its pixels the one that agrees best with its own bounding box
    (IoU). It is several cars that touch where no box covers so much, or where a tenth of it and more lies outside of
    that box and another covers most of that: then every pixel goes with the box it lies in, where boxes overlap with
    that of the lowest lower edge, which is the nearest car's. What lies in no moving box stands.
    """
    mask = np.where(cars > 0, MaskClass.NON_MOVING, MaskClass.BACKGROUND).astype(np.uint8)
    nearest_last = sorted(boxes, key=lambda box: box.y2)
    windows = [_window(box, cars.shape) for box in nearest_last]
    for piece in _pieces(cars):
        own = _own_box(piece, windows)
        if own is not None:
            if nearest_last[own].moving:
                mask[piece] = MaskClass.MOVING
            continue
        for box, window in zip(nearest_last, windows, strict=True):
            mask[window][piece[window]] = MaskClass.MOVING if box.moving else MaskClass.NON_MOVING
    return mask


def _own_box(piece: Piece, windows: Sequence[Window]) -> int | None:
    size = int(piece.sum())
    covering = [index for index, window in enumerate(windows) if piece[window].sum() >= COVERED * size]
    if not covering:
        return None
    bounds = _bounds(piece)
    # of equal ones the nearest car's
    own = max(covering, key=lambda index: (_iou(windows[index], bounds), index))
    outside = piece.copy()
    outside[windows[own]] = False
    left = int(outside.sum())
    others = [window for index, window in enumerate(windows) if index != own]
    shared = left >= _ANOTHER_CAR * size and any(outside[window].sum() >= COVERED * left for window in others)
    return None if shared else own


def _pieces(cars: npt.NDArray[np.uint8]) -> list[Piece]:
    values = [int(value) for value in np.unique(cars) if value]
    if len(values) > 1:
        return [cars == value for value in values]
    count, labels = cv2.connectedComponents((cars > 0).astype(np.uint8), connectivity=8)
    return [labels == number for number in range(1, count)]


def _window(box: MovingBox, shape: tuple[int, ...]) -> Window:
    y1, y2 = np.clip(np.rint((box.y1, box.y2)), 0, shape[0]).astype(int).tolist()
    x1, x2 = np.clip(np.rint((box.x1, box.x2)), 0, shape[1]).astype(int).tolist()
    return slice(y1, y2), slice(x1, x2)


def _bounds(piece: Piece) -> Window:
    x, y, width, height = cv2.boundingRect(piece.astype(np.uint8))
    return slice(y, y + height), slice(x, x + width)


def _iou(first: Window, second: Window) -> float:
    both = 1
    for one, other in zip(first, second, strict=True):
        both *= max(0, min(one.stop, other.stop) - max(one.start, other.start))
    union = (
        sum((window[0].stop - window[0].start) * (window[1].stop - window[1].start) for window in (first, second))
        - both
    )
    return both / union if union else 0.0
