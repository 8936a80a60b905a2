# SPDX-License-Identifier: Apache-2.0
"""The centre line of the street: road coordinates (s along, n to the left) to the world plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.placement import planar_pose

Floats = NDArray[np.float64]

LANE_CENTRE_M = 1.65
"""Distance of a lane's centre from the centre line; traffic keeps to the right."""
LANE_EDGE_M = 3.3
BAY_CENTRE_M = 4.4
KERB_M = 5.5
PAVEMENT_EDGE_M = 9.0
CROSS_HALF_WIDTH_M = 3.6
KERB_HEIGHT_M = 0.12
BEHIND_M, AHEAD_M = 40.0, 170.0
"""How far the street goes on behind the first camera and beyond the end of the drive."""

_STEP_M = 0.25
_MARGIN_M = 40.0


@dataclass(frozen=True, slots=True)
class Bend:
    """A bend from `start_m` on that turns by `angle_rad`, left positive; its curvature is a raised cosine."""

    start_m: float
    length_m: float
    angle_rad: float


class Road:
    """Centre line whose heading is the sum of smooth bends.

    World frame: x forward and y left at s = 0, z up, metres; s = 0, n = 0 lies at `origin` = (0, LANE_CENTRE_M), so
    that a camera in the right lane starts at x = y = 0.
    """

    def __init__(self, drive_length_m: float, seed: int) -> None:
        rng = np.random.default_rng([seed, 1])
        self.length_m = drive_length_m
        self.bends: list[Bend] = []
        self.junctions_m: list[float] = []
        side = 1.0 if rng.random() < 0.5 else -1.0
        start_m, heading = 52.0, 0.0
        while start_m < drive_length_m + 60.0:
            length_m = rng.uniform(62.0, 76.0)
            angle = side * np.deg2rad(rng.uniform(20.0, 30.0)) - 0.5 * heading
            self.bends.append(Bend(start_m, length_m, float(angle)))
            heading += float(angle)
            self.junctions_m.append(start_m + length_m + 13.0)
            start_m += length_m + 28.0
            side = -side
        self.junctions_m = [s for s in self.junctions_m if s < drive_length_m + 100.0]
        self._bend_start_m = np.array([bend.start_m for bend in self.bends])
        self._bend_length_m = np.array([bend.length_m for bend in self.bends])
        self._bend_angle_rad = np.array([bend.angle_rad for bend in self.bends])
        self._s = np.arange(-BEHIND_M - _MARGIN_M, drive_length_m + AHEAD_M + _MARGIN_M, _STEP_M)
        middle = self.heading(self._s[:-1] + 0.5 * _STEP_M)
        x = np.concatenate([[0.0], np.cumsum(np.cos(middle) * _STEP_M)])
        y = np.concatenate([[0.0], np.cumsum(np.sin(middle) * _STEP_M)])
        self._x = x - np.interp(0.0, self._s, x)
        self._y = y - np.interp(0.0, self._s, y) + LANE_CENTRE_M

    def heading(self, s: Floats | float) -> Floats:
        """Angle of the centre line against world x, radians, counter-clockwise."""
        x = (np.asarray(s, np.float64)[..., None] - self._bend_start_m) / self._bend_length_m
        x = np.minimum(np.maximum(x, 0.0), 1.0)
        turned = self._bend_angle_rad * (x - np.sin(2.0 * np.pi * x) / (2.0 * np.pi))
        return np.asarray(turned.sum(axis=-1))

    def point(self, s: Floats | float, n: Floats | float) -> Floats:
        """World (x, y) of road coordinates, shape (..., 2), metres; straight on beyond both ends."""
        s, n = np.broadcast_arrays(np.asarray(s, np.float64), np.asarray(n, np.float64))
        heading = self.heading(s)
        inside = np.minimum(np.maximum(s, self._s[0]), self._s[-1])
        beyond = s - inside
        cos, sin = np.cos(heading), np.sin(heading)
        x = np.interp(inside, self._s, self._x) + beyond * cos - n * sin
        y = np.interp(inside, self._s, self._y) + beyond * sin + n * cos
        return np.stack([x, y], axis=-1)

    def pose(self, s: float, n: float, yaw: float = 0.0, z: float = 0.0) -> Floats:
        """world_from_object, 4x4, of something that stands at (s, n), turned by `yaw` against the road."""
        matrix = planar_pose(self.point(s, n), float(self.heading(s)) + yaw)
        matrix[2, 3] = z
        return matrix

    def near_junction(self, s: float, margin_m: float) -> bool:
        """Whether a crossing street lies within `margin_m` of s."""
        return any(abs(s - junction) < margin_m for junction in self.junctions_m)
