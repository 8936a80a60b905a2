# SPDX-License-Identifier: Apache-2.0
"""How much of the image a thing would fill if nothing stood before it and the image had no border."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_NEAREST_M = 0.1
_CANVAS_PX = 384
"""Longer side of the silhouette as it is drawn, whatever its size in the image: an error of a percent at most."""
_SHIFT = 6
"""Binary digits behind the point of cv2's coordinates."""


class ProjectingCamera(Protocol):
    """A camera of `width` x `height` px that knows where points of its own frame appear."""

    @property
    def width(self) -> int: ...

    @property
    def height(self) -> int: ...

    def project(self, points_in_camera: Floats) -> Floats:
        """(..., 3) metres to (..., 2) px."""
        ...


@dataclass(frozen=True, slots=True)
class Silhouette:
    """whole_px: its area; inside_px: what of it lies in the image; box_px: left, top, right, bottom of that part."""

    whole_px: float
    inside_px: float
    box_px: tuple[float, float, float, float]


def silhouette(camera: ProjectingCamera, corners_in_camera: Floats) -> Silhouette | None:
    """Of triangles (T, 3, 3), metres in the camera's frame; None where they reach behind the camera or miss the image.

    Box coordinates count from the centre of the first pixel, and end within the image.
    """
    if corners_in_camera[..., 2].min() < _NEAREST_M:
        return None
    corners = camera.project(corners_in_camera)
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    scale = _CANVAS_PX / max(float((high - low).max()), 1e-3)
    width, height = np.ceil((high - low) * scale).astype(int) + 1
    canvas = np.zeros((height, width), np.uint8)
    fixed = np.rint((corners - low) * scale * 2**_SHIFT).astype(np.int32)
    for triangle in fixed:
        cv2.fillConvexPoly(canvas, triangle, 1, shift=_SHIFT)
    # The image's border, half a pixel beyond the centres of the outermost ones, on the canvas.
    left, top = np.maximum(np.rint((-0.5 - low) * scale), 0.0).astype(int)
    right, bottom = np.maximum(np.rint((np.array([camera.width, camera.height]) - 0.5 - low) * scale), 0.0).astype(int)
    inside = canvas[top:bottom, left:right]
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    if not len(rows):
        return None
    first = low + np.array([left + columns[0], top + rows[0]]) / scale
    last = low + np.array([left + columns[-1], top + rows[-1]]) / scale
    first, last = (np.clip(place, 0.0, [camera.width - 1.0, camera.height - 1.0]) for place in (first, last))
    return Silhouette(
        float(canvas.sum()) / scale**2,
        float(inside.sum()) / scale**2,
        (float(first[0]), float(first[1]), float(last[0]), float(last[1])),
    )
