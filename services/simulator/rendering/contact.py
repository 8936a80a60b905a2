# SPDX-License-Identifier: Apache-2.0
"""The dark ground below cars and people, where the sky's light does not reach; without it they seem to hover."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.pinhole import PinholeCamera

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

_REACH_M = 0.8
_DARKEST = 0.75
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
    """Darkens the ground round footprints in the image of one camera."""

    def __init__(self, camera: PinholeCamera) -> None:
        self._camera = camera
        self._x, self._y = camera.normalised(*camera.pixel_grid())

    def darken(
        self,
        colour: Floats32,
        depth_m: Floats32,
        on_ground: NDArray[np.bool_],
        world_from_camera: Floats,
        footprints: Sequence[Footprint],
    ) -> None:
        """Darken `colour` (H, W, 3) in place where `on_ground` (H, W) allows it."""
        for footprint in footprints:
            object_from_camera = np.linalg.inv(footprint.world_from_object) @ world_from_camera
            window = self._window(footprint, object_from_camera)
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
            shade = np.float32(_DARKEST) * near * near * (np.float32(3.0) - np.float32(2.0) * near)
            colour[window] *= (np.float32(1.0) - shade)[..., None]

    def _window(self, footprint: Footprint, object_from_camera: Floats) -> tuple[slice, slice] | None:
        """Part of the image that the shade may cover; None where that is nothing."""
        if not 0.0 < np.linalg.norm(object_from_camera[:3, 3]) < _RANGE_M:
            return None
        half = np.array([0.5 * footprint.length_m, 0.5 * footprint.width_m]) + _REACH_M
        corners = np.array([[sx * half[0], sy * half[1], z] for sx in (-1, 1) for sy in (-1, 1) for z in (-0.15, 0.25)])
        points = (corners - object_from_camera[:3, 3]) @ object_from_camera[:3, :3]
        if points[:, 2].max() < 0.2:
            return None
        width, height = self._camera.width, self._camera.height
        if points[:, 2].min() < 0.2:
            return np.s_[0:height, 0:width]
        place = self._camera.project(points)
        left, top = np.maximum(np.floor(place.min(axis=0)), 0.0).astype(int)
        right, bottom = np.minimum(np.ceil(place.max(axis=0)) + 1.0, [width, height]).astype(int)
        return np.s_[top:bottom, left:right] if left < right and top < bottom else None
