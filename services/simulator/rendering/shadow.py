# SPDX-License-Identifier: Apache-2.0
"""Cast shadows: which of the sunlit pixels something stands before the sun for."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.rendering.nearest import Surfaces

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

_FROM_M = 0.12
"""Nearer than this nothing casts a shadow: markings lie a little above the road they belong to."""


class SunShadow:
    """Looks from surface points towards the sun (`direction`, unit vector, (3,)) past all `surfaces`."""

    def __init__(self, direction: Floats, surfaces: list[Surfaces]) -> None:
        self._direction = direction.astype(np.float32)
        self._surfaces = surfaces

    def lit(
        self, world_from_camera: Floats, x: Floats32, y: Floats32, depth_m: Floats32, sunny: NDArray[np.bool_]
    ) -> Floats32:
        """1 where the sun is seen, 0 where not, (N, M); only pixels that are `sunny` are looked at."""
        which = np.flatnonzero(sunny)
        t = depth_m.ravel()[which]
        axes = world_from_camera.astype(np.float32)
        ray_x, ray_y = x.ravel()[which] * t, y.ravel()[which] * t
        point = np.empty((len(which), 3), np.float32)
        for k in range(3):
            point[:, k] = axes[k, 0] * ray_x + axes[k, 1] * ray_y + axes[k, 2] * t + axes[k, 3]
        for surfaces in self._surfaces:
            free = ~surfaces.rays.covered(point, self._direction, _FROM_M)
            which, point = which[free], point[free]
        lit = np.zeros(sunny.size, np.float32)
        lit[which] = 1.0
        return lit.reshape(sunny.shape)


def softened(lit: Floats32, sunny: NDArray[np.bool_]) -> Floats32:
    """The borders of shadows smoothed over 3 by 3 pixels, of sunny pixels among themselves."""
    weight = sunny.astype(np.float32)
    total = cv2.blur(weight, (3, 3), borderType=cv2.BORDER_REPLICATE)
    mean = cv2.blur(lit * weight, (3, 3), borderType=cv2.BORDER_REPLICATE)
    return np.asarray(np.where(sunny, mean / np.maximum(total, np.float32(1e-6)), np.float32(0.0)), np.float32)
