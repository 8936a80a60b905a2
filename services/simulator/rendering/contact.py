# SPDX-License-Identifier: Apache-2.0
"""The dark ground below cars and people, where the sky's light does not reach; without it they seem to hover."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.camera import Camera
from services.simulator.rendering.bounds import BOX_CORNERS, windows

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

_REACH_M = 0.8
_RANGE_M = 60.0
_GROUND_M = 0.25
"""Surfaces no higher than this above the feet count as ground."""


@dataclass(frozen=True, slots=True)
class Footprint:
    """Rectangle on the ground of somebody: world_from_object (4x4, x forward, z up) and length, width in metres."""

    world_from_object: Floats
    length_m: float
    width_m: float


class ContactShade:
    """Darkens the ground round footprints in the image of one camera, by the share `darkest` under a body."""

    def __init__(self, camera: Camera, darkest: float) -> None:
        self._camera, self._darkest = camera, np.float32(darkest)
        self._x, self._y = camera.normalised()

    def darken(
        self,
        colour: Floats32,
        depth_m: Floats32,
        on_ground: NDArray[np.bool_],
        world_from_camera: Floats,
        footprints: Sequence[Footprint],
    ) -> None:
        """Darken `colour` (H, W, 3) in place where `on_ground` (H, W) allows it."""
        if not footprints:
            return
        poses = np.array([footprint.world_from_object for footprint in footprints])
        near = np.linalg.norm(poses[:, :3, 3] - world_from_camera[:3, 3], axis=1) < _RANGE_M
        footprints = [footprint for footprint, is_near in zip(footprints, near, strict=True) if is_near]
        objects_from_camera = np.linalg.inv(poses[near]) @ world_from_camera
        boxes = windows(self._camera, _shade_boxes(footprints, objects_from_camera))
        for footprint, object_from_camera, window in zip(footprints, objects_from_camera, boxes, strict=True):
            if window is None:
                continue
            depth = np.where(on_ground[window], depth_m[window], np.float32(0.0))
            axes = object_from_camera.astype(np.float32)
            x, y = self._x[window] * depth, self._y[window] * depth
            along, across, height = (
                axes[k, 0] * x + axes[k, 1] * y + axes[k, 2] * depth + axes[k, 3] for k in range(3)
            )
            # The rectangle is drawn in a little, so that the shade is darkest under the body.
            outside_x = np.maximum(np.abs(along) - np.float32(0.5 * footprint.length_m - 0.15), 0.0)
            outside_y = np.maximum(np.abs(across) - np.float32(0.5 * footprint.width_m - 0.1), 0.0)
            near = 1.0 - np.sqrt(outside_x * outside_x + outside_y * outside_y) * np.float32(1.0 / _REACH_M)
            near = np.where(on_ground[window] & (height < _GROUND_M), np.maximum(near, 0.0), 0.0)
            shade = self._darkest * near * near * (np.float32(3.0) - np.float32(2.0) * near)
            colour[window] *= (np.float32(1.0) - shade)[..., None]


def _shade_boxes(footprints: Sequence[Footprint], objects_from_camera: Floats) -> Floats:
    """Corners of the boxes round what may be shaded, in the camera's frame, (F, 8, 3)."""
    half = np.array([[0.5 * f.length_m + _REACH_M, 0.5 * f.width_m + _REACH_M] for f in footprints]).reshape(-1, 2)
    low = np.column_stack([-half, np.full(len(half), -_GROUND_M)])
    corners = np.where(BOX_CORNERS, -low[:, None], low[:, None])
    return np.asarray((corners - objects_from_camera[:, None, :3, 3]) @ objects_from_camera[:, :3, :3])
