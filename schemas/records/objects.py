# SPDX-License-Identifier: Apache-2.0
"""What the tracker gives: the same object over time."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt


class MotionState(IntEnum):
    """What a landmark or an object can be."""

    STATIC = 0
    NON_MOVING = 1
    MOVING = 2
    UNDECIDED = 3
    POTENTIALLY_DYNAMIC = 4


@dataclass(frozen=True)
class ObjectTrack:
    """One object in one frame, its motion state filtered over its life."""

    object_id: int
    category: str
    score: float
    motion_state: MotionState
    moving_probability: float
    box_px: tuple[float, float, float, float]
    observed_frames: int


@dataclass(frozen=True)
class Objects:
    """`track_image` is uint32 (H, W): pixel = object id, 0 = background (thesis 3.1.3)."""

    timestamp_ns: int
    track_image: npt.NDArray[np.uint32]
    objects: tuple[ObjectTrack, ...]
    masks_age_frames: int = 0
