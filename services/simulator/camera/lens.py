# SPDX-License-Identifier: Apache-2.0
"""Models of lenses: where a direction (x / z, y / z) appears, and which direction a place shows.

Both sides are in units of the focal length; coefficients are OpenCV's.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from services.runtime.errors import InputError
from services.simulator.options import DriveOptions

Floats = NDArray[np.float64]

MAX_ANGLE_DEG = 85.0
"""Farthest from the optical axis that a pixel may look: depth along the axis has to mean something."""
_MAX_RADIUS = float(np.tan(np.deg2rad(MAX_ANGLE_DEG)))
_STEPS = 30
_PRECISION = 1e-11


class Lens(Protocol):
    """A lens. Arrays may have any shape."""

    @property
    def model(self) -> Literal["plumb_bob", "kannala_brandt"]:
        """The model's name in Foxglove's and ROS' calibrations."""
        ...

    @property
    def coefficients(self) -> tuple[float, ...]:
        """As OpenCV orders them; empty where the image is an ideal camera's."""
        ...

    def distorted(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Where directions appear."""
        ...

    def undistorted(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
        """Directions that places show, and the change of direction by place (root of the Jacobian's determinant).

        NaN where no direction within `MAX_ANGLE_DEG` appears.
        """
        ...


@dataclass(frozen=True)
class IdealLens:
    """No distortion."""

    model: Literal["plumb_bob", "kannala_brandt"] = "plumb_bob"
    coefficients: tuple[float, ...] = ()

    def distorted(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        return x, y

    def undistorted(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
        return x, y, np.ones_like(x)


@dataclass(frozen=True)
class RadialLens:
    """Brown-Conrady: k1 k2 p1 p2 k3 (Brown, Decentering Distortion of Lenses, 1966)."""

    coefficients: tuple[float, ...]
    model: Literal["plumb_bob", "kannala_brandt"] = "plumb_bob"

    def distorted(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        k1, k2, p1, p2, k3 = self.coefficients
        square = x * x + y * y
        radial = 1.0 + square * (k1 + square * (k2 + square * k3))
        cross = 2.0 * x * y
        return (
            x * radial + p1 * cross + p2 * (square + 2.0 * x * x),
            y * radial + p2 * cross + p1 * (square + 2.0 * y * y),
        )

    def undistorted(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
        """By Newton's method from the middle outwards: each step is at most as long as where it started."""
        wanted = np.stack([x, y])
        found = wanted.copy()
        for _ in range(_STEPS):
            xx, xy, yy = self._jacobian(*found)
            dx, dy = np.stack(self.distorted(*found)) - wanted
            determinant = xx * yy - xy * xy
            determinant = np.where(np.abs(determinant) < 1e-9, 1e-9, determinant)
            step = np.stack([yy * dx - xy * dy, xx * dy - xy * dx]) / determinant
            longest = np.maximum(np.hypot(*found), 0.05)
            step *= np.minimum(1.0, longest / np.maximum(np.hypot(*step), 1e-12))
            found -= step
            if np.abs(step).max(initial=0.0) < _PRECISION:
                break
        xx, xy, yy = self._jacobian(*found)
        determinant = xx * yy - xy * xy
        off = np.abs(np.stack(self.distorted(*found)) - wanted).max(axis=0)
        # Past the fold of a polynomial the picture would be mirrored.
        good = (off < 1e-8) & (determinant > 0.0) & (xx + yy > 0.0) & (np.hypot(*found) < _MAX_RADIUS)
        found = np.where(good, found, np.nan)
        return found[0], found[1], np.where(good, 1.0 / np.sqrt(np.where(good, determinant, 1.0)), np.nan)

    def _jacobian(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
        """Of `distorted`, which is symmetric: dx/dx, dx/dy, dy/dy."""
        k1, k2, p1, p2, k3 = self.coefficients
        square = x * x + y * y
        radial = 1.0 + square * (k1 + square * (k2 + square * k3))
        slope = 2.0 * (k1 + square * (2.0 * k2 + square * 3.0 * k3))
        return (
            radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
            x * y * slope + 2.0 * (p1 * x + p2 * y),
            radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
        )


@dataclass(frozen=True)
class FisheyeLens:
    """Kannala-Brandt: k1 k2 k3 k4 (Kannala and Brandt, A Generic Camera Model, 2006; OpenCV's fisheye)."""

    coefficients: tuple[float, ...]
    model: Literal["plumb_bob", "kannala_brandt"] = "kannala_brandt"

    def distorted(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        radius = np.hypot(x, y)
        scale = np.where(radius > 1e-9, self._place(np.arctan(radius))[0] / np.maximum(radius, 1e-9), 1.0)
        return x * scale, y * scale

    def undistorted(self, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
        place = np.hypot(x, y)
        angle = np.minimum(place, np.deg2rad(MAX_ANGLE_DEG))
        for _ in range(_STEPS):
            value, slope = self._place(angle)
            step = (value - place) / np.where(np.abs(slope) < 1e-6, 1e-6, slope)
            angle = np.clip(angle - step, 0.0, 0.5 * np.pi)
            if np.abs(step).max(initial=0.0) < _PRECISION:
                break
        value, slope = self._place(angle)
        good = (np.abs(value - place) < 1e-8) & (slope > 0.0) & (angle < np.deg2rad(MAX_ANGLE_DEG))
        angle = np.where(good, angle, np.nan)
        centre = place < 1e-9
        scale = np.where(centre, 1.0, np.tan(angle) / np.where(centre, 1.0, place))
        outwards = 1.0 / (np.cos(angle) ** 2 * np.where(good, slope, 1.0))
        return x * scale, y * scale, np.sqrt(outwards * scale)

    def _place(self, angle: Floats) -> tuple[Floats, Floats]:
        """Distance from the middle of an angle from the axis, and its slope."""
        k1, k2, k3, k4 = self.coefficients
        square = angle * angle
        value = angle * (1.0 + square * (k1 + square * (k2 + square * (k3 + square * k4))))
        slope = 1.0 + square * (3.0 * k1 + square * (5.0 * k2 + square * (7.0 * k3 + square * 9.0 * k4)))
        return value, slope


def lens_of(options: DriveOptions) -> Lens:
    """The lens that a drive asks for."""
    if options.lens == "pinhole":
        return IdealLens()
    coefficients = tuple(float(value) for value in options.distortion)
    return RadialLens(coefficients) if options.lens == "radial" else FisheyeLens(coefficients)


def expect_whole_image(options: DriveOptions, x: Floats) -> None:
    """Refuse a lens through which some pixel (x, NaN there) looks nowhere.

    Raises:
        InputError: naming the coefficients.
    """
    missing = float(np.isnan(x).mean())
    if missing:
        raise InputError(
            f"simulator distortion={options.distortion!r}: expected a {options.lens} lens through which every pixel "
            f"looks within {MAX_ANGLE_DEG:g} degrees of the axis, {100.0 * missing:.2g} % do not (raise fx_px?)"
        )
