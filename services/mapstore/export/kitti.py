# SPDX-License-Identifier: Apache-2.0
"""Trajectories as KITTI odometry writes them: the 3x4 first_camera_from_camera, row by row, 12 numbers a line."""

import numpy as np

from services.mapstore import sim3
from services.mapstore.map_view import MapView


def trajectory_kitti(view: MapView, map_id: int) -> str:
    """The frames of one map that have a pose, in the optical frame of the first of them (x right, y down, z forward).

    KITTI has no times and no way to leave a frame out: where frames were not tracked, the TUM file says which.
    """
    poses = view.final_poses()
    poses = poses[(view.frame_map_ids() == map_id) & np.isfinite(poses).all(axis=1)]
    if len(poses) == 0:
        return ""
    relative = sim3.compose_pose(np.broadcast_to(sim3.inverse_pose(poses[0]), poses.shape), poses)
    matrices = np.concatenate([sim3.rotation_matrices(relative[:, 3:7]), relative[:, :3, None]], axis=2)
    rows = matrices.reshape(-1, 12) + 0.0
    return "".join(" ".join(f"{number:.9e}" for number in row) + "\n" for row in rows.tolist())
