# SPDX-License-Identifier: Apache-2.0
"""The objects of one frame, as arrays that the engine takes."""

from enum import IntEnum
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt


class MotionCode(IntEnum):
    """The engine's codes of what an object does."""

    NON_MOVING = 1
    MOVING = 2


class FrameObjects(NamedTuple):
    """Track image (height, width) of ids, 0 where nobody is; and one row an object: id, COCO category, MotionCode."""

    track_image: npt.NDArray[np.uint32]
    ids: npt.NDArray[np.uint32]
    categories: npt.NDArray[np.int32]
    states: npt.NDArray[np.uint8]


class ObjectSource(Protocol):
    """Where the objects of a sequence come from; asked in the order of the frames."""

    def at(self, name: str) -> FrameObjects:
        """The objects of the frame of this name."""


def no_objects(height: int, width: int) -> FrameObjects:
    """Nobody in the image."""
    none = np.zeros(0)
    return FrameObjects(
        np.zeros((height, width), np.uint32), none.astype(np.uint32), none.astype(np.int32), none.astype(np.uint8)
    )
