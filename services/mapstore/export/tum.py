# SPDX-License-Identifier: Apache-2.0
"""Trajectories as the TUM RGB-D benchmark writes them: `timestamp_s tx ty tz qx qy qz qw`, one pose a line.

The first line is a comment that says what a length is; one map's export starts with it wherever it has a pose.
"""

import numpy as np
import numpy.typing as npt

from services.mapstore import sim3
from services.mapstore.map_view import MapView


def trajectory_tum(view: MapView, map_id: int) -> str:
    """map_from_camera of every frame of one map that has a pose, by its final keyframe's pose (culled ones too)."""
    frames = view.frames
    poses = view.final_poses()
    chosen = np.flatnonzero((view.frame_map_ids() == map_id) & np.isfinite(poses).all(axis=1))
    return _lines(_lengths(view, map_id), frames.timestamp_ns[chosen], poses[chosen])


def keyframes_tum(view: MapView, map_id: int) -> str:
    """map_from_camera of one map's keyframes that are not culled, by time."""
    keyframes = view.keyframes
    known = (keyframes.map_id == map_id) & (keyframes.culled == 0) & np.isfinite(keyframes.pose).all(axis=1)
    chosen = np.flatnonzero(known)
    chosen = chosen[np.lexsort((keyframes.id[chosen], keyframes.timestamp_ns[chosen]))]
    return _lines(_lengths(view, map_id), keyframes.timestamp_ns[chosen], keyframes.pose[chosen, :7])


def _lengths(view: MapView, map_id: int) -> str:
    """What a length of this map is; the store knows the scale of the newest frame's map only."""
    if map_id != view.map_id:
        return f"lengths in units of map {map_id}"
    return "lengths in metres" if view.metric_scale else "lengths in map units: the scale is arbitrary"


def _lines(lengths: str, timestamps_ns: npt.NDArray[np.int64], poses: sim3.Floats) -> str:
    if len(poses) == 0:
        return ""
    poses = np.concatenate([poses[:, :3], sim3.normalized(poses[:, 3:7])], axis=1)
    header = f"# timestamp_s tx ty tz qx qy qz qw; map_from_camera, {lengths}\n"
    return header + "".join(
        f"{stamp // 1_000_000_000}.{stamp % 1_000_000_000:09d} {' '.join(f'{number:.9f}' for number in pose)}\n"
        for stamp, pose in zip(timestamps_ns.tolist(), (poses + 0.0).tolist(), strict=True)
    )
