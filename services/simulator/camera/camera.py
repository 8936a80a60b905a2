# SPDX-License-Identifier: Apache-2.0
"""The camera: optical frame, z forward, x right, y down; the centre of the first pixel lies at (0, 0)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.lens import IdealLens, Lens, expect_whole_image, lens_of
from services.simulator.options import DriveOptions

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

_DEFAULT_FIELD_OF_VIEW_DEG = 80.0
_CENTRE = (0.0, 0.0)


@dataclass(frozen=True)
class Camera:
    """A camera with square pixels behind a lens."""

    width: int
    height: int
    fx_px: float
    lens: Lens = field(default_factory=IdealLens)

    @classmethod
    def from_options(cls, options: DriveOptions) -> Camera:
        """Camera of a drive.

        Raises:
            InputError: a lens that cannot fill the image.
        """
        default = 0.5 * options.width / np.tan(np.deg2rad(0.5 * _DEFAULT_FIELD_OF_VIEW_DEG))
        camera = cls(options.width, options.height, float(options.fx_px or default), lens_of(options))
        for offset in (-0.5, 0.5):
            expect_whole_image(options, camera._undistorted((offset, offset))[0])
        return camera

    @property
    def k(self) -> Floats:
        """Calibration matrix, 3x3."""
        return np.array(
            [
                [self.fx_px, 0.0, 0.5 * (self.width - 1)],
                [0.0, self.fx_px, 0.5 * (self.height - 1)],
                [0.0, 0.0, 1.0],
            ]
        )

    def projection(self, baseline_m: float = 0.0) -> Floats:
        """Projection matrix, 3x4, of a camera so far to the right of the first one in a rectified pair."""
        p = np.hstack([self.k, np.zeros((3, 1))])
        p[0, 3] = -self.fx_px * baseline_m
        return p

    def pixel_grid(self) -> tuple[Floats32, Floats32]:
        """Column and row of every pixel, each (height, width)."""
        rows, columns = np.mgrid[0 : self.height, 0 : self.width].astype(np.float32)
        return columns, rows

    def normalised(self, offset_px: tuple[float, float] = _CENTRE) -> tuple[Floats32, Floats32]:
        """Directions x / z and y / z seen at `offset_px` beside every pixel's centre, each (height, width)."""
        if offset_px not in self._directions:
            x, y, _ = self._undistorted(offset_px)
            self._directions[offset_px] = x.astype(np.float32), y.astype(np.float32)
        return self._directions[offset_px]

    @cached_property
    def pixel_extent(self) -> Floats32:
        """Change of direction from pixel to pixel: (), or (height, width) where the lens distorts."""
        if isinstance(self.lens, IdealLens):
            return np.array(1.0 / self.fx_px, np.float32)
        return (self._undistorted(_CENTRE)[2] / self.fx_px).astype(np.float32)

    def project(self, points_in_camera: Floats) -> Floats:
        """(..., 3) metres in the camera frame to (..., 2) pixels; NaN at or behind the camera's plane.

        Exact in the image and for a tenth around it; farther out, where polynomials fold back, it goes straight on.
        """
        z = np.where(points_in_camera[..., 2] > 1e-6, points_in_camera[..., 2], np.nan)
        place = points_in_camera[..., :2] / z[..., None]
        k = self.k
        if not isinstance(self.lens, IdealLens):
            inner = place * np.minimum(1.0, self._reach / np.maximum(np.linalg.norm(place, axis=-1), 1e-12))[..., None]
            place = place - inner + np.stack(self.lens.distorted(inner[..., 0], inner[..., 1]), axis=-1)
        return np.asarray(place * k[0, 0] + k[:2, 2])

    def windows(self, low: Floats, high: Floats, margin_px: float = 1.5) -> list[tuple[slice, slice] | None]:
        """Smallest parts of the image with every pixel whose direction lies between `low` and `high`, (B, 2), x and y.

        Rows and columns of each; None where there is no such pixel.
        """
        margin = margin_px * float(np.max(self.pixel_extent))
        bounds = []
        for axis, (largest_so_far, least_from_here) in enumerate(self._direction_ranges):
            bounds.append(np.searchsorted(largest_so_far, low[:, axis] - margin, "left"))
            bounds.append(np.searchsorted(least_from_here, high[:, axis] + margin, "right"))
        return [
            (slice(top, bottom), slice(left, right)) if left < right and top < bottom else None
            for left, right, top, bottom in np.stack(bounds, axis=1).tolist()
        ]

    @cached_property
    def _directions(self) -> dict[tuple[float, float], tuple[Floats32, Floats32]]:
        return {}

    @cached_property
    def _direction_ranges(self) -> list[tuple[Floats32, Floats32]]:
        """For columns and x, then for rows and y: the largest up to each, and the least from each on."""
        x, y = self.normalised()
        sides = (x.min(axis=0), x.max(axis=0)), (y.min(axis=1), y.max(axis=1))
        return [(np.maximum.accumulate(most), np.minimum.accumulate(least[::-1])[::-1]) for least, most in sides]

    @cached_property
    def _reach(self) -> float:
        """How far from the axis the lens' own formula is used, x / z and y / z."""
        x, y = self.normalised()
        corner = float(np.hypot(x, y).max())
        for share in np.linspace(1.1, 1.0, 6)[:-1]:
            ring = np.linspace(corner, share * corner, 16)
            if np.all(np.diff(self.lens.distorted(ring, np.zeros(16))[0]) > 0.0):
                return float(share * corner)
        return corner

    def _undistorted(self, offset_px: tuple[float, float]) -> tuple[Floats, Floats, Floats]:
        columns, rows = self.pixel_grid()
        k = self.k.astype(np.float32)
        place = [
            ((grid + np.float32(offset_px[axis]) - k[axis, 2]) / k[axis, axis]).astype(np.float64)
            for axis, grid in enumerate((columns, rows))
        ]
        return self.lens.undistorted(*place)
