# SPDX-License-Identifier: Apache-2.0
"""Who moves, in scenes where it is known. An estimator that always says no, or always yes, fails here."""

import numpy as np
import pytest

from services.motion.ego_motion import EgoMotionEstimator
from services.motion.ground_plane import fit_ground
from services.motion.instance_motion import InstanceMotionEstimator, MotionEvidence
from tests.unit.motion.synthetic_scene import CAMERA, Car, Scene, camera_motion, make_scene

SPEED_M = 0.8


def assess(cars: tuple[Car, ...], baseline_m: float = SPEED_M, yaw_rad: float = 0.0) -> dict[int, MotionEvidence]:
    motion, translation_m = camera_motion(baseline_m, yaw_rad)
    return assess_scene(make_scene(motion, translation_m, cars, noise_px=0.15), cars)


def assess_scene(scene: Scene, cars: tuple[Car, ...]) -> dict[int, MotionEvidence]:
    ego = EgoMotionEstimator().estimate(scene.samples, scene.background)
    assert ego.motion is not None
    ground = fit_ground(scene.samples, scene.background, ego.motion)
    estimator = InstanceMotionEstimator(scene.samples, scene.background, ego, ground=ground, camera=CAMERA)
    return {car.instance_id: estimator.assess(scene.labels, car.instance_id, "car", car.box_px) for car in cars}


@pytest.mark.parametrize("depth_m", [7.0, 10.0, 14.0])
@pytest.mark.parametrize("left_m", [-4.0, 0.5, 3.0])
@pytest.mark.parametrize("yaw_rad", [0.0, 0.02])
def test_a_parked_car_stands(left_m: float, depth_m: float, yaw_rad: float) -> None:
    found = assess((Car(1, left_m, depth_m),), yaw_rad=yaw_rad)[1]
    assert found.moving_probability < 0.4
    assert found.epipolar_residual_px < 2 * found.residual_noise_px


@pytest.mark.parametrize(
    ("left_m", "moved_m"),
    [
        (-3.0, (0.3, 0.0, 0.0)),  # crossing
        (1.5, (0.0, 0.0, SPEED_M)),  # ahead at our own speed: no parallax although near
        (1.5, (0.0, 0.0, 1.5 * SPEED_M)),  # pulling away: negative depth
        (-4.0, (0.0, 0.0, -SPEED_M)),  # oncoming: nearer than where it stands
    ],
)
def test_what_moves_is_found(left_m: float, moved_m: tuple[float, float, float]) -> None:
    assert assess((Car(1, left_m, 10.0, moved_m),))[1].moving_probability > 0.9


def test_motion_along_the_epipolar_line_leaves_no_epipolar_residual() -> None:
    found = assess((Car(1, 1.5, 10.0, (0.0, 0.0, SPEED_M)),))[1]
    assert found.epipolar_residual_px < 2 * found.residual_noise_px
    assert found.along_residual_px < -3 * found.along_noise_px


def test_neighbours_do_not_change_each_other() -> None:
    found = assess((Car(1, -4.0, 12.0, (0.0, 0.0, -SPEED_M)), Car(2, 2.5, 9.0), Car(3, -0.9, 15.0, (0.0, 0.0, 0.9))))
    assert found[1].moving_probability > 0.9
    assert found[2].moving_probability < 0.4
    assert found[3].moving_probability > 0.6


def test_a_hidden_contact_is_no_evidence_of_motion() -> None:
    before = Car(2, 0.3, 7.0, width_m=2.5, height_m=0.9)
    found = assess((Car(1, 0.5, 11.0), before))
    assert found[1].moving_probability < 0.55
    assert found[2].moving_probability < 0.4


def test_a_standing_camera_sees_who_moves() -> None:
    cars = (Car(1, -3.0, 10.0, (0.15, 0.0, 0.0)), Car(2, 2.0, 10.0))
    found = assess(cars, baseline_m=0.0)
    assert found[1].moving_probability > 0.9
    assert found[1].epipolar_residual_px == pytest.approx(5.7, abs=0.5)
    assert found[2].moving_probability < 0.2


def test_a_turning_camera_does_not_move_the_world() -> None:
    assert assess((Car(1, 2.0, 10.0),), baseline_m=0.0, yaw_rad=0.03)[1].moving_probability < 0.3


def test_too_few_samples_are_no_evidence() -> None:
    motion, translation_m = camera_motion(SPEED_M)
    cars = (Car(1, 20.0, 55.0, width_m=1.0),)
    found = assess_scene(make_scene(motion, translation_m, cars), cars)[1]
    assert found.moving_probability == 0.5
    assert found.samples < 5


def test_without_ego_motion_there_is_no_evidence() -> None:
    motion, translation_m = camera_motion(SPEED_M)
    scene = make_scene(motion, translation_m, (Car(1, 0.0, 10.0),))
    ego = EgoMotionEstimator().estimate(scene.samples, np.zeros(len(scene.samples), bool))
    estimator = InstanceMotionEstimator(scene.samples, scene.background, ego, ground=None, camera=CAMERA)
    assert estimator.assess(scene.labels, 1, "car", Car(1, 0.0, 10.0).box_px).moving_probability == 0.5
