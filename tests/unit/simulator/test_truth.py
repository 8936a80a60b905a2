# SPDX-License-Identifier: Apache-2.0
"""Depth, poses and flow agree with the images and with each other."""

from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from services.simulator.drive import Drive
from services.simulator.options import DriveOptions
from services.simulator.worlds.build import build_world
from services.simulator.worlds.world import World
from tests.benchmark.simulator.orb_features import WORLDS, orb_behaviour
from tests.benchmark.simulator.warp_errors import grey, pixel_grid, place_elsewhere, stereo_error, warp_errors

STRONG_GRADIENT = 10.0


def gradient(image: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.hypot(cv2.Sobel(image, cv2.CV_32F, 1, 0), cv2.Sobel(image, cv2.CV_32F, 0, 1)) / 8.0


SLOPES = {"world": "town", "traffic": 0.6, "max_slope": 0.1}
BUILT: dict[tuple[object, ...], World] = {}


@pytest.fixture(autouse=True)
def town_built_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lens, light and size of the image change nothing of what stands and moves."""

    def build(options: DriveOptions) -> World:
        key = (options.world, options.seed, options.traffic, options.max_slope, options.oncoming_cars)
        if key not in BUILT:
            BUILT[key] = build_world(options)
        return BUILT[key]

    monkeypatch.setattr("services.simulator.drive.build_world", build)


BARREL = {"lens": "radial", "distortion": (-0.25, 0.06, 0.001, -0.001, 0.0)}
FISHEYE = {"lens": "fisheye", "distortion": (0.02, -0.01, 0.003, -0.0005), "fx_px": 240.0}


@pytest.mark.parametrize("index", [3, 128, 205, 300])
def test_flow_and_depth_with_pose_say_the_same_of_what_stands(street: Drive, index: int) -> None:
    now, flow = street.render(index), street.flow(index)
    static = (now.labels == 0) & (now.depth_m > 0.0)
    next_from_now = np.linalg.inv(street.world_from_camera(index + 1)) @ now.world_from_camera
    by_flow = pixel_grid(now.labels.shape) + flow.flow_px
    by_pose, _ = place_elsewhere(street, now, next_from_now)
    # Straight ahead nothing moves, beside the car it does: a flow of zeros would fail here.
    assert np.percentile(np.linalg.norm(flow.flow_px[static], axis=-1), 90) > 5.0
    assert np.abs(by_flow - by_pose)[static & flow.visible].max() < 1e-3


@pytest.mark.parametrize(
    ("seed", "options"),
    [
        (1, {}),
        (2, {"stereo_baseline_m": 0.5}),
        (3, BARREL),
        (1, {"world": "town", "traffic": 0.0}),
        (6, {**SLOPES, "light": "low_sun", "shadows": True}),
        (3, {"world": "town", "stereo_baseline_m": 0.5, **FISHEYE}),
    ],
    ids=str,
)
def test_one_image_is_warped_into_another(seed: int, options: dict[str, Any]) -> None:
    drive = Drive(DriveOptions(seed=seed, **options))
    indices = (30, 128, 205)
    found = [warp_errors(drive, index) for index in indices]
    assert all(errors.share > 0.05 for errors in found)
    assert np.median([errors.by_flow for errors in found]) <= 3.0
    assert np.median([errors.by_depth_and_pose for errors in found]) <= 3.0
    assert np.median([errors.unmoved for errors in found]) > 8.0
    if drive.options.stereo_baseline_m:
        assert np.median([stereo_error(drive, index) for index in indices]) <= 3.0


@pytest.mark.parametrize("options", [BARREL, FISHEYE], ids=str)
def test_flow_through_a_lens_is_that_of_depth_and_pose(options: dict[str, Any]) -> None:
    drive = Drive(DriveOptions(width=320, height=96, **{**options, "fx_px": 150.0}))
    now, flow = drive.render(100), drive.flow(100)
    static = (now.labels == 0) & (now.depth_m > 0.0)
    next_from_now = np.linalg.inv(drive.world_from_camera(101)) @ now.world_from_camera
    by_pose, _ = place_elsewhere(drive, now, next_from_now)
    by_flow = pixel_grid(now.labels.shape) + flow.flow_px
    assert (static & flow.visible).mean() > 0.3
    assert np.abs(by_flow - by_pose)[static & flow.visible].max() < 2e-3


def test_flow_carries_moving_cars_and_people(street: Drive) -> None:
    compared_px = 0
    for index in range(90, 260, 17):
        now, then, flow = street.render(index), street.render(index + 1), street.flow(index)
        ids = [i.instance_id for i in now.instances if i.moving]
        image = grey(now.image)
        mask = np.isin(now.labels, ids) & flow.visible & (gradient(image) > STRONG_GRADIENT)
        at = pixel_grid(mask.shape) + flow.flow_px
        warped = grey(cv2.remap(then.image, at[..., 0], at[..., 1], cv2.INTER_LINEAR))
        if mask.sum() > 200:
            assert np.median(np.abs(warped - image)[mask]) <= 5.0
            compared_px += int(mask.sum())
    assert compared_px > 3000


def test_hidden_and_leaving_pixels_are_marked(street: Drive) -> None:
    flow = street.flow(200)
    at = pixel_grid(flow.visible.shape) + flow.flow_px
    height, width = flow.visible.shape
    outside = (at[..., 0] < 0) | (at[..., 1] < 0) | (at[..., 0] > width - 1) | (at[..., 1] > height - 1)
    assert outside.any()
    assert not flow.visible[outside].any()
    hidden = ~flow.visible & ~outside
    assert 0.001 < hidden.mean() < 0.25


def test_road_lies_at_the_cameras_height(street: Drive) -> None:
    """Depth of the road straight ahead follows from the height of the camera."""
    frame = street.render(0)
    k = street.camera.k
    pixel = pixel_grid(frame.labels.shape)
    ray = np.concatenate([pixel, np.ones((*frame.labels.shape, 1))], axis=-1) @ np.linalg.inv(k).T
    down = (ray @ frame.world_from_camera[:3, :3].T)[..., 2]
    height = frame.world_from_camera[2, 3]
    assert height == pytest.approx(1.65, abs=0.02)
    road = np.zeros(frame.labels.shape, bool)
    road[150:190, 220:340] = True
    assert not frame.labels[road].any()
    assert np.abs(frame.depth_m[road] + height / down[road]).max() < 0.1


@pytest.mark.parametrize("world", WORLDS)
def test_orb_finds_and_matches_features_as_on_real_images(world: str) -> None:
    drive = Drive(DriveOptions(width=1242, height=375, seed=1, **WORLDS[world]))
    found = [orb_behaviour(drive, index) for index in (30, 160)]
    assert min(behaviour.features for behaviour in found) >= 1500
    assert min(behaviour.right for behaviour in found) >= 0.6


@pytest.mark.parametrize("options", [{}, SLOPES, {"world": "corridor", "traffic": 0.8}], ids=str)
def test_surfaces_of_objects_lie_in_their_cuboids(options: dict[str, Any]) -> None:
    drive = Drive(DriveOptions(seed=6, **options))
    pitches = []
    for index in (60, 150, 240):
        frame = drive.render(index)
        x, y = drive.camera.normalised()
        point = np.stack([x, y, np.ones_like(x)], axis=-1) * frame.depth_m[..., None]
        in_world = point @ frame.world_from_camera[:3, :3].T + frame.world_from_camera[:3, 3]
        for found in frame.instances:
            relative = in_world[frame.labels == found.instance_id] - found.position_m
            cos, sin = np.cos(found.heading_rad), np.sin(found.heading_rad)
            level = relative @ np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
            cos, sin = np.cos(found.pitch_rad), np.sin(found.pitch_rad)
            own = level @ np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
            outside = np.abs(own) - 0.5 * np.array(found.size_m)
            assert np.percentile(outside.max(axis=1), 98) < 0.35, found
            pitches.append(abs(found.pitch_rad))
    assert len(pitches) > (10 if drive.options.world == "corridor" else 20)
    assert (max(pitches) > np.deg2rad(1.0)) == (drive.options.world == "town")
