# SPDX-License-Identifier: Apache-2.0
"""Which part of an image a box may cover."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.camera import Camera

Floats = NDArray[np.float64]
Window = tuple[slice, slice]

_NEAREST_M = 0.05
"""Nearer to the camera's plane nothing is seen."""
_EDGES = np.array([[a, a | bit] for bit in (1, 2, 4) for a in range(8) if not a & bit])
BOX_CORNERS = np.array([[bool(k & bit) for bit in (1, 2, 4)] for k in range(8)])
"""Which of both ends of x, y, z a corner has, (8, 3)."""


def windows(camera: Camera, corners_in_camera: Floats) -> list[Window | None]:
    """Rows and columns that boxes may cover; None where a box is not in sight.

    corners_in_camera: (B, 8, 3), in the order of `BOX_CORNERS`, metres. What lies behind the camera is cut off first.
    """
    depth = corners_in_camera[..., 2]
    start, end = corners_in_camera[:, _EDGES[:, 0]], corners_in_camera[:, _EDGES[:, 1]]
    crosses = (start[..., 2] < _NEAREST_M) != (end[..., 2] < _NEAREST_M)
    length = np.where(crosses, end[..., 2] - start[..., 2], 1.0)
    cut = start + ((_NEAREST_M - start[..., 2]) / length)[..., None] * (end - start)
    points = np.concatenate([corners_in_camera, cut], axis=1)
    seen = np.concatenate([depth >= _NEAREST_M, crosses], axis=1)
    place = points[..., :2] / np.where(seen, points[..., 2], 1.0)[..., None]
    # Boxes that are not in sight keep an infinite, empty range.
    low = np.where(seen[..., None], place, np.inf).min(axis=1)
    high = np.where(seen[..., None], place, -np.inf).max(axis=1)
    return camera.windows(low, high)
