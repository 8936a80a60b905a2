# SPDX-License-Identifier: Apache-2.0
"""Lines that actors of the floor follow. All floors are flat: z is a constant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.line import SampledLine

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class AlongCorridor:
    """Round the loop from `s_m` in `direction` (+1 or -1), `n_m` left of its centre; counted along the centre."""

    line: SampledLine
    s_m: float
    direction: float
    n_m: float

    def point(self, distance_m: Floats | float) -> Floats:
        """World position on the floor, (..., 3)."""
        s = self.s_m + self.direction * np.asarray(distance_m, np.float64)
        plane = self.line.point(s, self.n_m)
        return np.concatenate([plane, np.zeros((*plane.shape[:-1], 1))], axis=-1)

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        """Everywhere."""
        return np.ones(np.shape(distance_m), bool)


@dataclass(frozen=True, slots=True)
class ToAndFro:
    """From `from_xy` to `to_xy` and back for ever, turning on half circles of `radius_m` to the left; world plane."""

    from_xy: Floats
    to_xy: Floats
    radius_m: float

    def point(self, distance_m: Floats | float) -> Floats:
        """World position on the floor, (..., 3)."""
        way = self.to_xy - self.from_xy
        length = float(np.hypot(*way))
        ahead = way / length
        left = np.array([-ahead[1], ahead[0]])
        bend = np.pi * self.radius_m
        at = np.asarray(distance_m, np.float64) % (2.0 * (length + bend))
        back = at >= length + bend
        along = np.where(back, at - length - bend, at)
        angle = np.maximum(along - length, 0.0) / self.radius_m
        x = np.minimum(along, length) + self.radius_m * np.sin(angle)
        y = self.radius_m * (-np.cos(angle))
        x, y = np.where(back, length - x, x), np.where(back, -y, y)
        plane = self.from_xy + x[..., None] * ahead + y[..., None] * left
        return np.concatenate([plane, np.zeros((*plane.shape[:-1], 1))], axis=-1)

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        """Everywhere."""
        return np.ones(np.shape(distance_m), bool)


@dataclass(frozen=True, slots=True)
class Standing:
    """Nowhere but at a pose (4x4, world_from_object); the way gone only says which way it looks."""

    world_from_object: Floats

    def point(self, distance_m: Floats | float) -> Floats:
        """World position, (..., 3)."""
        gone = np.asarray(distance_m, np.float64)[..., None]
        return np.asarray(self.world_from_object[:3, 3] + gone * self.world_from_object[:3, 0])

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        """Everywhere."""
        return np.ones(np.shape(distance_m), bool)
