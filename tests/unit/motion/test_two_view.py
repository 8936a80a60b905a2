# SPDX-License-Identifier: Apache-2.0
"""The geometry of two views, against points whose depth is known."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from services.motion.two_view import CameraMotion, PinholeCamera, measure_parallax, predict_along, rotation_from_vector

finite = st.floats(-0.05, 0.05)


def seen_before(motion: CameraMotion, current: np.ndarray, inverse_depth: np.ndarray) -> np.ndarray:
    points = np.column_stack((current, np.ones(len(current)))) @ motion.rotation.T
    points += inverse_depth[:, None] * motion.translation
    return points[:, :2] / points[:, 2:]


def points() -> np.ndarray:
    return np.random.default_rng(3).uniform(-0.8, 0.8, (50, 2))


@given(finite, finite, finite, st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_standing_points_lie_on_their_epipolar_lines_at_their_depth(rx, ry, rz, tx, ty):
    translation = np.array([tx, ty, 1.0]) / np.linalg.norm([tx, ty, 1.0])
    motion = CameraMotion(rotation_from_vector(np.array([rx, ry, rz])), translation)
    current, inverse_depth = points(), np.random.default_rng(4).uniform(0.01, 0.2, 50)
    parallax = measure_parallax(motion, current, seen_before(motion, current, inverse_depth))
    np.testing.assert_allclose(parallax.across, 0.0, atol=1e-9)
    np.testing.assert_allclose(parallax.inverse_depth, inverse_depth, atol=1e-7)
    np.testing.assert_allclose(parallax.along, predict_along(motion, current, inverse_depth), atol=1e-9)


def test_gain_is_the_slope_of_the_displacement():
    motion = CameraMotion(rotation_from_vector(np.array([0.01, -0.02, 0.0])), np.array([0.0, 0.0, 1.0]))
    current, inverse_depth, step = points(), np.full(50, 0.05), 1e-6
    parallax = measure_parallax(motion, current, seen_before(motion, current, inverse_depth))
    slope = (predict_along(motion, current, inverse_depth + step) - parallax.along) / step
    np.testing.assert_allclose(parallax.gain, slope, rtol=1e-3)


def test_a_point_that_runs_ahead_has_negative_depth():
    motion = CameraMotion(np.eye(3), np.array([0.0, 0.0, 1.0]))
    current = np.array([[0.1, 0.05]])
    parallax = measure_parallax(motion, current, current * 1.02)
    assert parallax.inverse_depth[0] < 0


def test_without_baseline_the_whole_displacement_is_left():
    motion = CameraMotion(np.eye(3), np.zeros(3))
    parallax = measure_parallax(motion, np.zeros((1, 2)), np.array([[0.03, 0.04]]))
    assert not motion.has_baseline
    assert parallax.length[0] == pytest.approx(0.05)
    assert (parallax.across[0], parallax.along[0]) == pytest.approx((0.03, 0.04))


def test_normalise_takes_distortion_out():
    intrinsics = np.array([[400.0, 0.0, 320.0], [0.0, 400.0, 240.0], [0.0, 0.0, 1.0]])
    straight, k1 = np.array([[0.4, 0.2]]), -0.2
    bent = straight * (1.0 + k1 * np.sum(straight**2))
    pixels = bent * 400.0 + intrinsics[:2, 2]
    np.testing.assert_allclose(
        PinholeCamera(intrinsics, (k1, 0.0, 0.0, 0.0, 0.0)).normalise(pixels), straight, atol=1e-4
    )
    np.testing.assert_allclose(PinholeCamera(intrinsics).normalise(pixels), bent, atol=1e-12)


def test_normalise_takes_a_fisheye_out():
    intrinsics = np.array([[400.0, 0.0, 320.0], [0.0, 400.0, 240.0], [0.0, 0.0, 1.0]])
    angle, k1 = 0.9, -0.05
    bent = angle * (1.0 + k1 * angle**2)
    pixels = np.array([[320.0 + 400.0 * bent, 240.0]])
    camera = PinholeCamera(intrinsics, (k1, 0.0, 0.0, 0.0), fisheye=True)
    np.testing.assert_allclose(camera.normalise(pixels), [[np.tan(angle), 0.0]], atol=1e-6)
