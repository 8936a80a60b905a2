# SPDX-License-Identifier: Apache-2.0
"""What slam gives: poses and changes of the map."""

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

import numpy as np
import numpy.typing as npt


class TrackingState(IntEnum):
    """How the camera tracker stands."""

    INITIALIZING = 0
    TRACKING = 1
    LOST = 2


class MaskSource(IntEnum):
    """Which masks kept moving things out of a pose."""

    NO_MASKS = 0
    FRESH = 1
    CARRIED = 2


@dataclass(frozen=True)
class TrackedFrame:
    """One frame's pose. Poses and covariance are None when the frame was not tracked."""

    timestamp_ns: int
    state: TrackingState
    reason: str
    map_id: int
    map_from_camera: npt.NDArray[np.float64] | None
    """(7,) tx ty tz qx qy qz qw"""
    covariance: npt.NDArray[np.float64] | None
    """(6, 6), translation then rotation"""
    reference_keyframe_id: int
    camera_from_reference: npt.NDArray[np.float64] | None
    """(7,)"""
    features: int
    tracked_landmarks: int
    keyframe_inserted: bool
    masks: MaskSource
    metric_scale: bool
    handling: str
    moving_unplaced: int = 0
    stage_ms: dict[str, float] = field(default_factory=dict)
    loop_closed: bool = False
    """a place of this map was recognised: many keyframes moved"""
    maps_merged: bool = False
    """a place of another map was recognised: both are one now"""


@dataclass(frozen=True)
class PoseInMap:
    """A pose for viewers and planners: map_from_`child` as (7,) tx ty tz qx qy qz qw."""

    timestamp_ns: int
    pose: npt.NDArray[np.float64]


def _no_rows(dtype: type[np.generic], *columns: int) -> Any:
    return field(default_factory=lambda: np.empty((0, *columns), dtype=dtype))


@dataclass(frozen=True)
class MapUpdate:
    """Everything of the map that changed with a frame; the arrays' rows belong together by prefix.

    A landmark's position is in its anchor keyframe's camera frame; `keyframe_pose` is the Sim(3) map_from_keyframe as
    tx ty tz qx qy qz qw scale; a culled keyframe stays as a pose-only node; `removed_landmark_id` are tombstones;
    `dense_keyframe_*` are keyframes whose semi-dense map was finished, or replaced, with this update, each with its
    number of rows of `dense_point_*` (positions in that keyframe's camera frame, seen at its time);
    `frame_*` are poses of earlier frames that became known with this update.
    """

    timestamp_ns: int
    map_id: int = 0
    metric_scale: bool = False
    keyframe_id: npt.NDArray[np.int64] = _no_rows(np.int64)
    keyframe_timestamp_ns: npt.NDArray[np.int64] = _no_rows(np.int64)
    keyframe_map_id: npt.NDArray[np.int64] = _no_rows(np.int64)
    keyframe_pose: npt.NDArray[np.float64] = _no_rows(np.float64, 8)
    keyframe_culled: npt.NDArray[np.uint8] = _no_rows(np.uint8)
    keyframe_parent_id: npt.NDArray[np.int64] = _no_rows(np.int64)
    landmark_id: npt.NDArray[np.int64] = _no_rows(np.int64)
    landmark_anchor_id: npt.NDArray[np.int64] = _no_rows(np.int64)
    landmark_position: npt.NDArray[np.float32] = _no_rows(np.float32, 3)
    landmark_state: npt.NDArray[np.uint8] = _no_rows(np.uint8)
    landmark_category: npt.NDArray[np.int32] = _no_rows(np.int32)
    landmark_object_id: npt.NDArray[np.uint32] = _no_rows(np.uint32)
    landmark_first_seen_ns: npt.NDArray[np.int64] = _no_rows(np.int64)
    landmark_last_seen_ns: npt.NDArray[np.int64] = _no_rows(np.int64)
    landmark_valid_until_ns: npt.NDArray[np.int64] = _no_rows(np.int64)
    removed_landmark_id: npt.NDArray[np.int64] = _no_rows(np.int64)
    dense_keyframe_id: npt.NDArray[np.int64] = _no_rows(np.int64)
    dense_keyframe_points: npt.NDArray[np.int32] = _no_rows(np.int32)
    dense_point_position: npt.NDArray[np.float32] = _no_rows(np.float32, 3)
    dense_point_depth_sigma: npt.NDArray[np.float32] = _no_rows(np.float32)
    dense_point_grey: npt.NDArray[np.uint8] = _no_rows(np.uint8)
    dense_point_state: npt.NDArray[np.uint8] = _no_rows(np.uint8)
    dense_point_category: npt.NDArray[np.int16] = _no_rows(np.int16)
    dense_point_object_id: npt.NDArray[np.uint32] = _no_rows(np.uint32)
    frame_timestamp_ns: npt.NDArray[np.int64] = _no_rows(np.int64)
    frame_reference_keyframe_id: npt.NDArray[np.int64] = _no_rows(np.int64)
    frame_camera_from_reference: npt.NDArray[np.float64] = _no_rows(np.float64, 7)
