# SPDX-License-Identifier: Apache-2.0
"""The map as it was after one frame: immutable, so that any thread may read it without a lock."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from schemas.records import MappedObject, TrackingState
from services.mapstore import sim3
from services.mapstore.landmark_cluster import LandmarkCluster

NOT_YET = -1
"""The sequence number before the first frame."""


@dataclass(frozen=True)
class KeyframeColumns:
    """One row a keyframe, culled ones included. A row whose `pose` is NaN is known by name only."""

    id: npt.NDArray[np.int64]
    timestamp_ns: npt.NDArray[np.int64]
    map_id: npt.NDArray[np.int64]
    pose: npt.NDArray[np.float64]
    """(K, 8) Sim(3) map_from_keyframe"""
    culled: npt.NDArray[np.uint8]
    parent_id: npt.NDArray[np.int64]
    bound_centre: npt.NDArray[np.float64]
    """(K, 3) of a sphere around the cluster, in the map frame"""
    bound_radius: npt.NDArray[np.float64]
    """(K,) of the same, in map units; negative where the cluster is empty"""
    camera_reach: npt.NDArray[np.float64]
    """(K,) how far from the keyframe the cameras are that refer to it, in map units; negative where there is none"""
    counts: npt.NDArray[np.int64]
    """(K, 5) landmarks by MotionState"""


@dataclass(frozen=True)
class FrameColumns:
    """One row a frame, in order of `sequence`."""

    sequence: npt.NDArray[np.int64]
    timestamp_ns: npt.NDArray[np.int64]
    state: npt.NDArray[np.uint8]
    map_id: npt.NDArray[np.int64]
    """the map it was in at the time; see MapView.frame_map_ids"""
    reference_row: npt.NDArray[np.int64]
    """row of KeyframeColumns, -1: the frame has no pose"""
    camera_from_reference: npt.NDArray[np.float64]
    """(F, 7), NaN without a pose"""
    live_pose: npt.NDArray[np.float64]
    """(F, 7) map_from_camera as first reported, NaN without a pose"""


@dataclass(frozen=True)
class MapView:
    """Everything a query or an export needs. Lengths are metres where `metric_scale`, else map units."""

    session: str
    sequence: int
    timestamp_ns: int
    map_id: int
    metric_scale: bool
    state: TrackingState
    reason: str
    handling: str
    keyframes: KeyframeColumns
    clusters: tuple[LandmarkCluster, ...]
    cameras: tuple[npt.NDArray[np.float64], ...]
    """for each keyframe the camera centres (N, 3) that refer to it, in its frame"""
    frames: FrameColumns
    sightings: Mapping[int, npt.NDArray[np.int64]]
    """object id -> times at which it was seen moving, rising"""
    dense_points: int = 0
    """of all semi-dense maps; they are in the file only"""
    objects: tuple[MappedObject, ...] = ()
    """cuboids of the objects that the newest frame shows; none where the map is not metric"""

    def final_poses(self) -> npt.NDArray[np.float64]:
        """(F, 7) map_from_camera of every frame: camera_from_reference under the reference's newest pose; NaN for none.

        A frame whose reference keyframe never became known keeps the pose it was first reported with.
        """
        frames = self.frames
        poses = frames.live_pose.copy()
        rows = np.flatnonzero(frames.reference_row >= 0)
        references = self.keyframes.pose[frames.reference_row[rows]]
        composed = sim3.compose_pose(references, sim3.inverse_pose(frames.camera_from_reference[rows]))
        whole = np.isfinite(composed).all(axis=1)
        poses[rows[whole]] = composed[whole]
        return poses

    def frame_map_ids(self) -> npt.NDArray[np.int64]:
        """(F,) the map each frame is in: that of its reference keyframe, which may have gone into another map since."""
        frames, map_ids = self.frames, self.frames.map_id.copy()
        rows = np.flatnonzero(frames.reference_row >= 0)
        known = np.isfinite(self.keyframes.pose[frames.reference_row[rows], 0])
        map_ids[rows[known]] = self.keyframes.map_id[frames.reference_row[rows[known]]]
        return map_ids

    def current_pose(self) -> npt.NDArray[np.float64] | None:
        """(7,) map_from_camera of the newest frame, None where it was not tracked."""
        if len(self.frames.sequence) == 0 or not np.isfinite(self.frames.live_pose[-1]).all():
            return None
        newest: npt.NDArray[np.float64] = self.frames.live_pose[-1]
        return newest

    def counts_by_state(self) -> npt.NDArray[np.int64]:
        """(5,) landmarks of each MotionState in every map."""
        total: npt.NDArray[np.int64] = self.keyframes.counts.sum(axis=0)
        return total
