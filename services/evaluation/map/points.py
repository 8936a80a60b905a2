# SPDX-License-Identifier: Apache-2.0
"""The map as its updates leave it: for counting and drawing, independent of the store that a run filled."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from schemas.records import MapUpdate, MotionState


class Points(NamedTuple):
    """Landmarks in the frame of one map: `position` (N, 3), `state` (N,) of MotionState, sorted by landmark id."""

    landmark_id: npt.NDArray[np.int64]
    position: npt.NDArray[np.float64]
    state: npt.NDArray[np.uint8]


class MapPoints:
    """Landmarks and keyframes after all updates so far. A landmark's last row counts, and a removed one not at all."""

    def __init__(self) -> None:
        self._keyframes: dict[int, tuple[int, bool, npt.NDArray[np.float64]]] = {}
        self._landmarks: dict[int, tuple[int, int, npt.NDArray[np.float32]]] = {}

    def add(self, update: MapUpdate) -> None:
        """Apply one update; updates come in the order they were sent."""
        for row, keyframe_id in enumerate(update.keyframe_id.tolist()):
            self._keyframes[keyframe_id] = (
                int(update.keyframe_map_id[row]),
                bool(update.keyframe_culled[row]),
                update.keyframe_pose[row],
            )
        for row, landmark_id in enumerate(update.landmark_id.tolist()):
            self._landmarks[landmark_id] = (
                int(update.landmark_anchor_id[row]),
                int(update.landmark_state[row]),
                update.landmark_position[row],
            )
        for landmark_id in update.removed_landmark_id.tolist():
            self._landmarks.pop(landmark_id, None)

    def counts_by_label(self) -> dict[str, int]:
        """Landmarks of every motion state by its name in lower case; states without any are 0."""
        states = np.array([state for _, state, _ in self._landmarks.values()], dtype=np.int64)
        counts = np.bincount(states, minlength=len(MotionState))
        return {state.name.lower(): int(counts[state]) for state in MotionState}

    @property
    def keyframes(self) -> int:
        """Keyframes that were not culled."""
        return sum(not culled for _, culled, _ in self._keyframes.values())

    @property
    def maps(self) -> int:
        """Maps that hold a keyframe; more than one where tracking was lost and started anew."""
        return len({map_id for map_id, culled, _ in self._keyframes.values() if not culled})

    def points(self, map_id: int) -> Points:
        """The landmarks of one map in its frame: map_from_keyframe (a Sim(3)) applied to each anchored position."""
        rows = sorted(
            landmark_id
            for landmark_id, (anchor_id, _, _) in self._landmarks.items()
            if anchor_id in self._keyframes and self._keyframes[anchor_id][0] == map_id
        )
        if not rows:
            return Points(np.empty(0, np.int64), np.empty((0, 3)), np.empty(0, np.uint8))
        landmarks = [self._landmarks[landmark_id] for landmark_id in rows]
        poses = np.array([self._keyframes[anchor_id][2] for anchor_id, _, _ in landmarks])
        local = np.array([position for _, _, position in landmarks], dtype=np.float64)
        position = poses[:, 7:8] * Rotation.from_quat(poses[:, 3:7]).apply(local) + poses[:, :3]
        state = np.array([state for _, state, _ in landmarks], dtype=np.uint8)
        return Points(np.array(rows, dtype=np.int64), position, state)
