# SPDX-License-Identifier: Apache-2.0
"""The camera: optical frame, z forward, x right, y down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.options import DriveOptions

Floats = NDArray[np.float64]

_DEFAULT_FIELD_OF_VIEW_DEG = 80.0


@dataclass(frozen=True, slots=True)
class PinholeCamera:
    """Ideal camera with square pixels; the centre of the first pixel lies at (0, 0)."""

    width: int
    height: int
    fx_px: float

    @classmethod
    def from_options(cls, options: DriveOptions) -> PinholeCamera:
        """Camera of a drive."""
        default = 0.5 * options.width / np.tan(np.deg2rad(0.5 * _DEFAULT_FIELD_OF_VIEW_DEG))
        return cls(options.width, options.height, float(options.fx_px or default))

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

    def pixel_grid(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Column and row of every pixel, each (height, width)."""
        rows, columns = np.mgrid[0 : self.height, 0 : self.width].astype(np.float32)
        return columns, rows

    def normalised(
        self, columns: NDArray[np.float32], rows: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Pixel coordinates to x / z and y / z."""
        k = self.k.astype(np.float32)
        return (columns - k[0, 2]) / k[0, 0], (rows - k[1, 2]) / k[1, 1]

    def project(self, points_in_camera: Floats) -> Floats:
        """(..., 3) metres in the camera frame to (..., 2) pixels; NaN at or behind the camera's plane."""
        z = np.where(points_in_camera[..., 2] > 1e-6, points_in_camera[..., 2], np.nan)
        k = self.k
        return np.asarray(points_in_camera[..., :2] / z[..., None] * k[0, 0] + k[:2, 2])
