# SPDX-License-Identifier: Apache-2.0
"""The landmarks and camera positions of one keyframe: what a map correction moves as one piece."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from schemas.records import MotionState

STATES = len(MotionState)


@dataclass(frozen=True)
class LandmarkCluster:
    """Immutable arrays of one keyframe's landmarks, ordered by id; positions (N, 3) in its camera frame."""

    landmark_id: npt.NDArray[np.int64]
    position: npt.NDArray[np.float32]
    state: npt.NDArray[np.uint8]
    category: npt.NDArray[np.int32]
    object_id: npt.NDArray[np.uint32]
    first_seen_ns: npt.NDArray[np.int64]
    last_seen_ns: npt.NDArray[np.int64]
    valid_until_ns: npt.NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.landmark_id)

    @cached_property
    def moving(self) -> npt.NDArray[np.intp]:
        """The rows of moving landmarks."""
        return np.flatnonzero(self.state == MotionState.MOVING)

    def counts_by_state(self) -> npt.NDArray[np.int64]:
        """(5,) landmarks of each MotionState."""
        return np.bincount(self.state, minlength=STATES)[:STATES]

    def bound(self) -> tuple[npt.NDArray[np.float64], float]:
        """Centre (3,) and radius of a sphere in the keyframe's frame around every landmark; radius -1 for none."""
        if len(self) == 0:
            return np.zeros(3), -1.0
        points = self.position.astype(np.float64)
        centre = (points.min(axis=0) + points.max(axis=0)) / 2
        return centre, float(np.sqrt(np.max(np.sum((points - centre) ** 2, axis=1))))


def empty_cluster() -> LandmarkCluster:
    """A keyframe without landmarks."""
    return LandmarkCluster(
        np.empty(0, np.int64),
        np.empty((0, 3), np.float32),
        np.empty(0, np.uint8),
        np.empty(0, np.int32),
        np.empty(0, np.uint32),
        np.empty(0, np.int64),
        np.empty(0, np.int64),
        np.empty(0, np.int64),
    )
