# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.evaluation.trajectory.alignment import Alignment, Similarity
from services.evaluation.trajectory.pose_alignment import align_poses
from services.runtime.errors import InputError


def _poses(positions: np.ndarray) -> np.ndarray:
    poses = np.tile(np.eye(4), (len(positions), 1, 1))
    poses[:, :3, 3] = positions
    return poses


def test_a_straight_way_leaves_no_roll_open() -> None:
    target = _poses(np.outer(np.arange(20.0), (0.0, 0.0, 1.0)))
    rng = np.random.default_rng(3)
    found = Similarity(Rotation.random(rng=rng).as_matrix(), rng.normal(size=3), 0.2)
    inverse = Similarity(found.rotation.T, -found.rotation.T @ found.translation / found.scale, 1 / found.scale)
    source = inverse.poses(target)
    source[:, :3, 3] += rng.normal(0.0, 1e-3, (20, 3))  # enough for positions alone to roll by anything
    truth_from_map = align_poses(source, target, Alignment.SIM3)
    assert truth_from_map.scale == pytest.approx(found.scale, rel=1e-3)
    beside_the_way = rng.normal(0.0, 10.0, (50, 3))
    at = inverse.points(beside_the_way)
    np.testing.assert_allclose(truth_from_map.points(at), beside_the_way, atol=0.02)


def test_the_scale_stays_where_it_is_not_free() -> None:
    source = _poses(np.random.default_rng(1).normal(size=(9, 3)))
    target = _poses(3.0 * source[:, :3, 3])
    assert align_poses(source, target, Alignment.SIM3).scale == pytest.approx(3.0)
    assert align_poses(source, target, Alignment.SE3).scale == 1.0
    np.testing.assert_array_equal(align_poses(source, target, Alignment.NONE).points(np.eye(3)), np.eye(3))


def test_poses_at_one_place_are_refused() -> None:
    with pytest.raises(InputError, match="at one place"):
        align_poses(_poses(np.ones((9, 3))), _poses(np.eye(9, 3)), Alignment.SIM3)
