# SPDX-License-Identifier: Apache-2.0
"""Objects in the map: a car that drives ahead, one that stands, by road contact and by depth."""

import numpy as np
import numpy.typing as npt
import pytest

from schemas.records.mapped_objects import MappedObject
from schemas.records.objects import MotionState, Objects, ObjectTrack
from services.slam.object_tracks import CameraView, ObjectTracks

HEIGHT_M, FOCAL_PX, CX, CY = 1.6, 400.0, 320.0, 100.0
SHAPE = (240, 640)
CAR_LENGTH_M, CAR_WIDTH_M = 4.2, 1.8
OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""map_from_camera: the camera looks along x of a map with z up"""


def _rays(pixels: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return (pixels - [CX, CY]) / FOCAL_PX


def _view(forward_m: float) -> CameraView:
    pose = np.eye(4)
    pose[:3, :3] = OPTICAL
    pose[:3, 3] = (forward_m, 0.0, HEIGHT_M)
    return CameraView(pose, FOCAL_PX, HEIGHT_M, _rays)


def _seen(center_x_m: float, camera_x_m: float, state: MotionState, time_s: float) -> tuple[Objects, np.ndarray, float]:
    """A car ahead, from behind: its row, its contact with the road, and the distance to its rear."""
    rear_m = center_x_m - CAR_LENGTH_M / 2 - camera_x_m
    half = CAR_WIDTH_M / 2 / rear_m * FOCAL_PX
    low = CY + HEIGHT_M / rear_m * FOCAL_PX
    top = low - 1.5 / rear_m * FOCAL_PX
    image = np.zeros(SHAPE, np.uint32)
    image[round(top) : round(low) + 1, round(CX - half) : round(CX + half) + 1] = 3
    row = ObjectTrack(3, "car", 1.0, state, 0.9, (CX - half, top, 2 * half, low - top), 1)
    wheels_m = rear_m + 0.2 * CAR_LENGTH_M
    contact = np.array([[side * CAR_WIDTH_M / 2, HEIGHT_M, wheels_m] for side in (-1, 0, 1)])
    return Objects(round(time_s * 1e9), image, (row,)), contact, rear_m


def _follow(speed_m_s: float, state: MotionState, *, by_depth: bool) -> tuple[MappedObject, float]:
    """The car after 3 s, and where it is then; the camera drives at 2 m/s."""
    tracks = ObjectTracks()
    mapped: tuple[MappedObject, ...] = ()
    for index in range(31):
        time_s = 0.1 * index
        center = 14.0 + speed_m_s * time_s
        objects, contact, rear_m = _seen(center, 2.0 * time_s, state, time_s)
        depth = None
        if by_depth:
            depth = np.where(objects.track_image > 0, rear_m, 0.0).astype(np.float32)
        mapped = tracks.update(objects, _view(2.0 * time_s), {} if by_depth else {3: contact}, depth)
    return mapped[0], center


@pytest.mark.parametrize("by_depth", [False, True], ids=["road", "depth"])
def test_a_car_ahead_has_its_place_and_speed(by_depth: bool) -> None:
    car, center = _follow(6.0, MotionState.MOVING, by_depth=by_depth)
    assert car.by_depth == by_depth
    assert car.position[:2] == pytest.approx((center, 0.0), abs=0.5)
    assert car.position[2] == pytest.approx(0.75, abs=0.2)
    assert car.velocity[:2] == pytest.approx((6.0, 0.0), abs=0.3)
    assert car.heading_rad == pytest.approx(0.0, abs=0.1)
    assert 0.0 < car.velocity_sigma < 2.0


def test_a_standing_car_has_no_speed() -> None:
    car, center = _follow(0.0, MotionState.NON_MOVING, by_depth=False)
    assert np.linalg.norm(car.velocity) < 0.05
    assert car.position[:2] == pytest.approx((center, 0.0), abs=0.5)


def test_an_object_without_contact_or_depth_is_not_placed() -> None:
    objects, _, _ = _seen(14.0, 0.0, MotionState.MOVING, 0.1)
    assert ObjectTracks().update(objects, _view(0.0), {}) == ()
    nothing = np.zeros(SHAPE, np.float32)
    assert ObjectTracks().update(objects, _view(0.0), {}, nothing) == ()


def test_another_map_begins_with_no_speed() -> None:
    tracks = ObjectTracks()
    for index in range(11):
        objects, contact, _ = _seen(14.0 + 0.6 * index, 0.0, MotionState.MOVING, 0.1 * index)
        (car,) = tracks.update(objects, _view(0.0), {3: contact})
    assert car.velocity[0] > 3.0
    tracks.forget()
    (car,) = tracks.update(objects, _view(0.0), {3: contact})
    assert car.velocity == (0.0, 0.0, 0.0)
