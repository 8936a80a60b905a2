# SPDX-License-Identifier: Apache-2.0
"""How well a simulated image is reproduced from another one by what is said to be true of it.

Judged are static pixels that are seen in both images and whose gradient (Sobel) is among the strongest fifth: flat
walls prove nothing. Projections are OpenCV's, not the simulator's.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.drive import Drive
from services.simulator.frame import SimulatedFrame

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

_STRONGEST = 0.2


@dataclass(frozen=True)
class WarpErrors:
    """Medians of grey level differences. unmoved: without any warping, to compare; share: of pixels that are judged."""

    by_flow: float
    by_depth_and_pose: float
    unmoved: float
    share: float


def grey(image: NDArray[np.uint8]) -> Floats32:
    """Grey levels with fractions, (H, W)."""
    return np.asarray(cv2.cvtColor(image.astype(np.float32), cv2.COLOR_BGR2GRAY))


def pixel_grid(shape: tuple[int, ...]) -> Floats32:
    """Column and row of each pixel, (H, W, 2)."""
    rows, columns = np.mgrid[0 : shape[0], 0 : shape[1]].astype(np.float32)
    return np.stack([columns, rows], axis=-1)


def strongest(image: Floats32, candidates: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The fifth of the candidates whose gradient is strongest."""
    strength = np.hypot(cv2.Sobel(image, cv2.CV_32F, 1, 0), cv2.Sobel(image, cv2.CV_32F, 0, 1))
    return candidates & (strength >= np.quantile(strength[candidates], 1.0 - _STRONGEST))


def warped(image: Floats32, place: NDArray[np.floating]) -> Floats32:
    """`image` looked up at places (H, W, 2)."""
    at = place.astype(np.float32)
    return np.asarray(cv2.remap(image, at[..., 0], at[..., 1], cv2.INTER_LINEAR))


def place_elsewhere(drive: Drive, frame: SimulatedFrame, other_from_camera: Floats) -> tuple[Floats, Floats]:
    """Where another camera with the same lens sees each pixel's point, (H, W, 2), and how deep, (H, W)."""
    k, lens = drive.camera.k, drive.camera.lens
    coefficients = np.array(lens.coefficients or (0.0,) * 5)
    pixel = pixel_grid(frame.labels.shape).reshape(-1, 1, 2).astype(np.float64)
    if lens.model == "kannala_brandt":
        ray = cv2.fisheye.undistortPoints(pixel, k, coefficients, criteria=(3, 50, 1e-12))
    else:
        ray = cv2.undistortPoints(pixel, k, coefficients, criteria=(3, 50, 1e-12))
    depth = frame.depth_m.reshape(-1, 1).astype(np.float64)
    point = np.hstack([ray.reshape(-1, 2), np.ones_like(depth)]) * depth
    point = point @ other_from_camera[:3, :3].T + other_from_camera[:3, 3]
    ahead = np.where(point[:, 2:] > 0.05, point, [0.0, 0.0, 1.0]).reshape(-1, 1, 3)
    project = cv2.fisheye.projectPoints if lens.model == "kannala_brandt" else cv2.projectPoints
    place = project(ahead, np.zeros(3), np.zeros(3), k, coefficients)[0].reshape(*frame.labels.shape, 2)
    depth_there = point[:, 2].reshape(frame.labels.shape)
    return np.where(depth_there[..., None] > 0.05, place, -1e6), depth_there


def warp_errors(drive: Drive, index: int) -> WarpErrors:
    """Frame `index` reproduced from the next one."""
    now, then, flow = drive.render(index), drive.render(index + 1), drive.flow(index)
    image, next_image = grey(now.image), grey(then.image)
    judged = strongest(image, (now.labels == 0) & (now.depth_m > 0.0) & flow.visible)
    next_from_now = np.linalg.inv(then.world_from_camera) @ now.world_from_camera
    by_pose, _ = place_elsewhere(drive, now, next_from_now)
    found = [warped(next_image, pixel_grid(image.shape) + flow.flow_px), warped(next_image, by_pose), next_image]
    return WarpErrors(*(float(np.median(np.abs(other - image)[judged])) for other in found), float(judged.mean()))


def stereo_error(drive: Drive, index: int) -> float:
    """The left image reproduced from the right one by depth."""
    frame = drive.render(index)
    assert frame.image_right is not None
    right_from_left = np.eye(4)
    right_from_left[0, 3] = -drive.options.stereo_baseline_m
    place, depth = place_elsewhere(drive, frame, right_from_left)
    image, right = grey(frame.image), grey(frame.image_right)
    judged = strongest(image, (frame.depth_m > 0.0) & _seen_there(place, depth))
    return float(np.median(np.abs(warped(right, place) - image)[judged]))


def _seen_there(place: Floats, depth: Floats) -> NDArray[np.bool_]:
    """Whether nothing that this image shows hides a pixel's point in the other one."""
    height, width = depth.shape
    cell = np.rint(place).astype(int)
    inside = (cell[..., 0] >= 0) & (cell[..., 0] < width) & (cell[..., 1] >= 0) & (cell[..., 1] < height) & (depth > 0)
    flat = np.where(inside, cell[..., 1] * width + cell[..., 0], 0)
    nearest = np.full(height * width, 1e9)
    np.minimum.at(nearest, flat[inside], depth[inside])
    around = cv2.erode(nearest.reshape(height, width), np.ones((3, 3)))
    return inside & (depth < 1.05 * around.ravel()[flat])
