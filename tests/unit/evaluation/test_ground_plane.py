# SPDX-License-Identifier: Apache-2.0
import numpy as np
from scipy.spatial.transform import Rotation

from services.evaluation.trajectory.ground_plane import ground_plane


def _one_pose(rotation: np.ndarray) -> np.ndarray:
    pose = np.eye(4)[None].copy()
    pose[0, :3, :3] = rotation
    return pose


def test_optical_world_is_seen_in_x_and_z() -> None:
    plane = ground_plane(_one_pose(Rotation.from_euler("x", 5, degrees=True).as_matrix()))
    assert plane.names == ("x", "z")
    np.testing.assert_array_equal(plane.project(np.array([[1.0, 2.0, 3.0]])), [[1.0, 3.0]])


def test_world_with_z_up_is_seen_in_x_and_y() -> None:
    # Columns: where the camera's right, down and forward point in a world of x forward, y left, z up.
    assert ground_plane(_one_pose(np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]]))).names == ("x", "y")


def test_the_view_from_above_is_right_handed() -> None:
    for seed in range(20):
        rotation = Rotation.random(rng=np.random.default_rng(seed)).as_matrix()
        first, second = ground_plane(_one_pose(rotation)).axes
        up = np.cross(np.eye(3)[first], np.eye(3)[second])
        assert up @ rotation[:, 1] < 0.0
