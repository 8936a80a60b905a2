# SPDX-License-Identifier: Apache-2.0
"""Images of a road and a wall that a camera drives along, with a car before it: each pixel's ray is cast on planes."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from schemas.records import CameraCalibration, Image, Instance, Instances

WIDTH, HEIGHT, FOCAL_PX = 320, 160, 260.0
INTRINSICS = np.array([[FOCAL_PX, 0.0, 160.0], [0.0, FOCAL_PX, 60.0], [0.0, 0.0, 1.0]])
FRAME_NS = 100_000_000
SPEED_M = 0.6


def _texture(seed: int) -> npt.NDArray[np.float32]:
    random = np.random.default_rng(seed)
    layers = [
        cv2.resize(random.random((side, side), np.float32), (1024, 1024), interpolation=cv2.INTER_CUBIC)
        for side in (64, 256, 1024)
    ]
    return np.asarray(sum(layers) / len(layers), np.float32)


TEXTURES = [_texture(seed) for seed in range(3)]


def _paint(texture: npt.NDArray[np.float32], u_m: np.ndarray, v_m: np.ndarray) -> np.ndarray:
    """Grey of a texture of 16 pixels a metre, repeated."""
    return cv2.remap(
        texture,
        np.mod(16.0 * u_m, 1000.0).astype(np.float32),
        np.mod(16.0 * v_m, 1000.0).astype(np.float32),
        cv2.INTER_LINEAR,
    )


@dataclass(frozen=True)
class Picture:
    """What the motion service takes of one frame."""

    image: Image
    calibration: CameraCalibration
    instances: Instances


def picture(index: int, car_step_m: float | None = None, car_start_m: float = 12.0) -> Picture:
    """Frame `index` of a camera that drives SPEED_M a frame; a car ahead moves `car_step_m` a frame (None: no car)."""
    columns, rows = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    x, y = (columns - INTRINSICS[0, 2]) / FOCAL_PX, (rows - INTRINSICS[1, 2]) / FOCAL_PX
    road = np.where(y > 1e-3, 1.65 / np.maximum(y, 1e-3), np.inf)
    wall = np.where(np.abs(x) > 1e-3, 6.0 / np.maximum(np.abs(x), 1e-3), np.inf)
    depth = np.minimum(np.minimum(road, wall), 80.0)
    along_m = depth + SPEED_M * index
    on_road, on_wall = _paint(TEXTURES[0], x * depth + 40.0, along_m), _paint(TEXTURES[1], along_m, y * depth + 40.0)
    grey = np.where(road <= wall, on_road, on_wall)
    grey = np.where(depth >= 80.0, _paint(TEXTURES[1], 10.0 * x + 20.0, 10.0 * y + 20.0), grey)
    labels = np.zeros((HEIGHT, WIDTH), np.uint32)
    instances: tuple[Instance, ...] = ()
    if car_step_m is not None:
        car_depth_m = car_start_m + (car_step_m - SPEED_M) * index
        car_x_m, car_y_m = x * car_depth_m, y * car_depth_m
        on_car = (car_x_m > 0.4) & (car_x_m < 2.6) & (car_y_m > -0.1) & (car_y_m < 1.65)
        grey = np.where(on_car, _paint(TEXTURES[2], 3.0 * car_x_m + 40.0, 3.0 * car_y_m + 40.0), grey)
        labels[on_car] = 1 + index % 3
        instances = (Instance(1 + index % 3, "car", 0.9, (0.0, 0.0, 0.0, 0.0)),)
    pixels = np.clip(30.0 + 200.0 * grey, 0, 255).astype(np.uint8)
    time_ns = index * FRAME_NS
    return Picture(
        Image(time_ns, pixels),
        CameraCalibration(time_ns, WIDTH, HEIGHT, INTRINSICS),
        Instances(time_ns, labels, instances),
    )
