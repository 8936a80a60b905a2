# SPDX-License-Identifier: Apache-2.0
"""Depth, poses and flow agree with the images and with each other."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from services.simulator.drive import Drive

STRONG_GRADIENT = 10.0


def grey(image: NDArray[np.uint8]) -> NDArray[np.float32]:
    return cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(np.float32)


def gradient(image: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.hypot(cv2.Sobel(image, cv2.CV_32F, 1, 0), cv2.Sobel(image, cv2.CV_32F, 0, 1)) / 8.0


def pixel_grid(shape: tuple[int, ...]) -> NDArray[np.float32]:
    rows, columns = np.mgrid[0 : shape[0], 0 : shape[1]].astype(np.float32)
    return np.stack([columns, rows], axis=-1)


def place_by_depth_and_pose(street: Drive, index: int) -> NDArray[np.float64]:
    """Where each pixel's static point appears in the next frame, by a projection of the test's own."""
    frame = street.render(index)
    k = street.camera.k
    pixel = np.concatenate([pixel_grid(frame.labels.shape), np.ones((*frame.labels.shape, 1))], axis=-1)
    point = (pixel @ np.linalg.inv(k).T) * frame.depth_m[..., None]
    next_from_now = np.linalg.inv(street.world_from_camera(index + 1)) @ frame.world_from_camera
    image = (point @ next_from_now[:3, :3].T + next_from_now[:3, 3]) @ k.T
    return image[..., :2] / np.maximum(image[..., 2:], 1e-9)


@pytest.mark.parametrize("index", [3, 128, 205, 300])
def test_flow_and_depth_with_pose_carry_one_image_into_the_next(street: Drive, index: int) -> None:
    now, then = street.render(index), street.render(index + 1)
    flow = street.flow(index)
    static = (now.labels == 0) & (now.depth_m > 0.0)
    by_flow = pixel_grid(now.labels.shape) + flow.flow_px
    by_pose = place_by_depth_and_pose(street, index)
    # Straight ahead nothing moves, beside the car it does: a flow of zeros would fail here.
    assert np.percentile(np.linalg.norm(flow.flow_px[static], axis=-1), 90) > 5.0
    assert np.abs(by_flow - by_pose)[static & flow.visible].max() < 1e-3

    image = grey(now.image)
    compared = static & flow.visible & (gradient(image) > STRONG_GRADIENT)
    assert compared.mean() > 0.05
    for place in (by_flow, by_pose):
        at = place.astype(np.float32)
        warped = grey(cv2.remap(then.image, at[..., 0], at[..., 1], cv2.INTER_LINEAR))
        assert np.median(np.abs(warped - image)[compared]) <= 3.0
    unmoved = np.abs(grey(then.image) - image)[compared]
    assert np.median(unmoved) > 8.0


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
