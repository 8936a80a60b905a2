# SPDX-License-Identifier: Apache-2.0
"""The camera's motion from flow with noise, outliers and traffic."""

import numpy as np
import pytest

from services.motion.ego_motion import EgoMotionEstimator
from services.motion.two_view import CameraMotion
from tests.unit.motion.synthetic_scene import Car, Scene, camera_motion, make_scene


def rotation_error_deg(first: np.ndarray, second: np.ndarray) -> float:
    return float(np.degrees(np.arccos(np.clip((np.trace(first.T @ second) - 1.0) / 2.0, -1.0, 1.0))))


def direction_error_deg(first: np.ndarray, second: np.ndarray) -> float:
    return float(np.degrees(np.arccos(np.clip(first @ second, -1.0, 1.0))))


def estimate(scene: Scene, before: CameraMotion | None = None):
    return EgoMotionEstimator().estimate(scene.samples, scene.background, before)


@pytest.mark.parametrize(("yaw", "pitch"), [(0.0, 0.0), (0.02, 0.0), (-0.03, 0.004)])
def test_driving_ahead_with_a_quarter_of_outliers(yaw: float, pitch: float) -> None:
    truth, translation_m = camera_motion(0.8, yaw, pitch)
    found = estimate(make_scene(truth, translation_m, noise_px=0.15, outlier_share=0.25))
    assert found.motion is not None
    assert found.reason == ""
    assert rotation_error_deg(found.motion.rotation, truth.rotation) < 0.05
    assert direction_error_deg(found.motion.translation, truth.translation) < 1.0
    assert np.linalg.norm(found.motion.translation) == pytest.approx(1.0)
    assert 0.6 < found.inlier_ratio < 0.9
    assert found.samples > 200
    assert found.parallax_px > 3.0


def test_a_camera_that_steps_aside_is_not_taken_for_one_that_turns() -> None:
    rotation = np.eye(3)
    truth = CameraMotion(rotation, np.array([0.8, 0.0, 0.6]))
    found = estimate(make_scene(truth, 0.7 * truth.translation, noise_px=0.1))
    assert found.motion is not None
    assert direction_error_deg(found.motion.translation, truth.translation) < 5.0


def test_a_pure_turn_has_no_baseline() -> None:
    truth, translation_m = camera_motion(0.0, yaw_rad=0.03)
    found = estimate(make_scene(truth, translation_m, noise_px=0.1, outlier_share=0.05))
    assert found.motion is not None
    assert not found.motion.has_baseline
    assert found.reason == "no baseline"
    assert rotation_error_deg(found.motion.rotation, truth.rotation) < 0.02
    assert found.background_flow_px > 5.0


def test_a_standing_camera_stands_though_cars_pass() -> None:
    truth, translation_m = camera_motion(0.0)
    car = Car(1, -2.0, 9.0, (0.6, 0.0, 0.0), width_m=4.0)
    found = estimate(make_scene(truth, translation_m, (car,), noise_px=0.05))
    assert found.motion is not None
    assert not found.motion.has_baseline
    assert found.parallax_px < 0.35


def test_unlabelled_traffic_does_not_win_over_the_background() -> None:
    truth, translation_m = camera_motion(0.8)
    cars = (Car(1, -3.0, 10.0, (0.5, 0.0, 0.3), width_m=3.0), Car(2, 1.0, 8.0, (0.0, 0.0, 0.8)))
    scene = make_scene(truth, translation_m, cars)
    found = EgoMotionEstimator().estimate(scene.samples, np.ones(len(scene.samples), bool))
    assert found.motion is not None
    assert direction_error_deg(found.motion.translation, truth.translation) < 2.0


def test_too_little_background_is_said_not_guessed() -> None:
    truth, translation_m = camera_motion(0.8)
    scene = make_scene(truth, translation_m)
    few = np.zeros(len(scene.samples), bool)
    few[::400] = True
    found = EgoMotionEstimator().estimate(scene.samples, few)
    assert found.motion is None
    assert "at least 40 are needed" in found.reason


def test_flow_without_any_order_is_said_not_guessed() -> None:
    truth, translation_m = camera_motion(0.8)
    found = estimate(make_scene(truth, translation_m, outlier_share=1.0))
    assert found.motion is None
    assert "agrees" in found.reason


def test_the_same_samples_give_the_same_motion() -> None:
    truth, translation_m = camera_motion(0.8, 0.01)
    scene = make_scene(truth, translation_m, outlier_share=0.3)
    first, second = estimate(scene), estimate(scene)
    assert first.motion is not None
    assert second.motion is not None
    assert first.motion.rotation.tobytes() == second.motion.rotation.tobytes()
    assert first.motion.translation.tobytes() == second.motion.translation.tobytes()
