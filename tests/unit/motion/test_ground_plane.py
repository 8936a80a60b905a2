# SPDX-License-Identifier: Apache-2.0
"""The road from flow."""

import numpy as np
import pytest

from services.motion.ground_plane import blend_normal, fit_ground
from services.motion.two_view import CameraMotion
from tests.unit.motion.synthetic_scene import CAMERA_HEIGHT_M, Car, camera_motion, make_scene


@pytest.mark.parametrize("baseline_m", [0.4, 0.8, 1.2])
def test_height_and_normal_of_the_road(baseline_m: float) -> None:
    motion, translation_m = camera_motion(baseline_m, yaw_rad=0.01)
    scene = make_scene(motion, translation_m, noise_px=0.2, outlier_share=0.1)
    ground = fit_ground(scene.samples, scene.background, motion)
    assert ground is not None
    assert ground.height * baseline_m == pytest.approx(CAMERA_HEIGHT_M, rel=0.04)
    np.testing.assert_allclose(ground.normal, (0.0, 1.0, 0.0), atol=0.02)
    foot = np.array([[0.1, CAMERA_HEIGHT_M / 12.0]])
    assert ground.inverse_depth(foot)[0] == pytest.approx(baseline_m / 12.0, rel=0.05)


def test_unlabelled_cars_do_not_lift_the_road() -> None:
    motion, translation_m = camera_motion(0.8)
    cars = (Car(1, -1.0, 9.0, (0.0, 0.0, 0.7)), Car(2, 2.5, 7.0))
    scene = make_scene(motion, translation_m, cars)
    ground = fit_ground(scene.samples, np.ones(len(scene.samples), bool), motion)
    assert ground is not None
    assert ground.height * 0.8 == pytest.approx(CAMERA_HEIGHT_M, rel=0.05)


def test_no_road_without_baseline_or_samples() -> None:
    motion, translation_m = camera_motion(0.8)
    scene = make_scene(motion, translation_m)
    assert fit_ground(scene.samples, scene.background, CameraMotion(np.eye(3), np.zeros(3))) is None
    assert fit_ground(scene.samples, scene.samples.current[:, 1] < 0.0, motion) is None


def test_normals_of_images_are_blended() -> None:
    down, tilted = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.995, 0.0998])
    assert blend_normal(None, tilted, 0.8) is tilted
    blended = blend_normal(down, tilted, 0.8)
    assert np.linalg.norm(blended) == pytest.approx(1.0)
    assert blended[2] == pytest.approx(0.02, abs=0.001)
