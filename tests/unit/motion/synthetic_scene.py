# SPDX-License-Identifier: Apache-2.0
"""A street of points with known flow: a road, two walls, and boxes that stand or move on the road."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.motion.flow_samples import FlowSamples
from services.motion.two_view import CameraMotion, FloatArray, PinholeCamera, rotation_from_vector

WIDTH, HEIGHT, FOCAL_PX = 640, 192, 380.0
INTRINSICS = np.array([[FOCAL_PX, 0.0, 320.0], [0.0, FOCAL_PX, 80.0], [0.0, 0.0, 1.0]])
CAMERA = PinholeCamera(INTRINSICS)
CAMERA_HEIGHT_M = 1.65
WALL_M = 9.0


@dataclass(frozen=True)
class Car:
    """A box's face towards the camera. `moved_m` is how far it went since the image before, camera x, y, z."""

    instance_id: int
    left_m: float
    depth_m: float
    moved_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    width_m: float = 1.8
    height_m: float = 1.5

    @property
    def box_px(self) -> tuple[int, int, int, int]:
        """x, y, width, height in the current image."""
        left = round(INTRINSICS[0, 2] + FOCAL_PX * self.left_m / self.depth_m)
        right = round(INTRINSICS[0, 2] + FOCAL_PX * (self.left_m + self.width_m) / self.depth_m)
        top = round(INTRINSICS[1, 2] + FOCAL_PX * (CAMERA_HEIGHT_M - self.height_m) / self.depth_m)
        bottom = round(INTRINSICS[1, 2] + FOCAL_PX * CAMERA_HEIGHT_M / self.depth_m)
        left, right = max(0, left), min(WIDTH, right)
        return left, top, right - left, min(HEIGHT, bottom) - top


@dataclass(frozen=True)
class Scene:
    """What motion sees of one image pair."""

    samples: FlowSamples
    labels: npt.NDArray[np.uint32]
    background: npt.NDArray[np.bool_]


def camera_motion(baseline_m: float, yaw_rad: float = 0.0, pitch_rad: float = 0.0) -> tuple[CameraMotion, FloatArray]:
    """previous_from_current of a camera that drove ahead, translation of unit length (or none), and that in metres."""
    rotation = rotation_from_vector(np.array([pitch_rad, yaw_rad, 0.0]))
    translation_m = rotation @ np.array([0.0, 0.0, baseline_m])
    unit = translation_m / baseline_m if baseline_m else np.zeros(3)
    return CameraMotion(rotation, unit), translation_m


def make_scene(
    motion: CameraMotion,
    translation_m: FloatArray,
    cars: tuple[Car, ...] = (),
    *,
    noise_px: float = 0.1,
    outlier_share: float = 0.0,
    seed: int = 1,
) -> Scene:
    """Samples at every fourth pixel whose flow is exact but for Gaussian noise and a share of random outliers."""
    rows, columns = np.mgrid[2:HEIGHT:4, 2:WIDTH:4]
    pixel = np.column_stack((columns.ravel(), rows.ravel())).astype(np.int32)
    current = CAMERA.normalise(pixel.astype(np.float64))
    depth = np.full(len(pixel), 60.0)
    below = current[:, 1] > 1e-6
    depth[below] = np.minimum(depth[below], CAMERA_HEIGHT_M / current[below, 1])
    aside = np.abs(current[:, 0]) > 1e-6
    depth[aside] = np.minimum(depth[aside], WALL_M / np.abs(current[aside, 0]))
    moved = np.zeros((len(pixel), 3))
    labels = np.zeros((HEIGHT, WIDTH), np.uint32)
    for car in sorted(cars, key=lambda car: -car.depth_m):
        x, y, width, height = car.box_px
        labels[y : y + height, x : x + width] = car.instance_id
        on_car = labels[pixel[:, 1], pixel[:, 0]] == car.instance_id
        depth[on_car], moved[on_car] = car.depth_m, car.moved_m

    points = np.column_stack((current, np.ones(len(pixel)))) * depth[:, None] - moved
    points = points @ motion.rotation.T + translation_m
    was = points[:, :2] / points[:, 2:] * FOCAL_PX + INTRINSICS[:2, 2]
    random = np.random.default_rng(seed)
    was += random.normal(0.0, noise_px, was.shape)
    wrong = random.random(len(pixel)) < outlier_share
    was[wrong] += random.uniform(-15.0, 15.0, (int(wrong.sum()), 2))
    inside = np.all((was >= 0) & (was < (WIDTH, HEIGHT)), axis=1)

    samples = FlowSamples(
        pixel[inside],
        current[inside],
        CAMERA.normalise(was[inside]),
        (was - pixel)[inside],
        random.uniform(1.0, 2.0, len(pixel))[inside],
        FOCAL_PX,
    )
    background = labels[samples.pixel[:, 1], samples.pixel[:, 0]] == 0
    return Scene(samples, labels, background)
