# SPDX-License-Identifier: Apache-2.0
"""How the camera's car drives through the street. World frame: see `road.Road`; the camera starts above x = y = 0."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.placement import BASE_FROM_OPTICAL, rotation_about
from services.simulator.options import DriveOptions
from services.simulator.worlds.street.road import LANE_CENTRE_M, Road

Floats = NDArray[np.float64]


class EgoTrajectory:
    """The camera's car: right lane, nearly constant speed, and the small sway, pitch and bounce of a real car."""

    def __init__(self, options: DriveOptions, road: Road) -> None:
        self._road = road
        self._speed_m_s = options.speed_m_s
        self._height_m = options.camera_height_m
        self._offset_m = options.lateral_offset_m - LANE_CENTRE_M

    def distance_m(self, t_s: Floats | float) -> Floats:
        """Way driven along the road since the start; the speed varies by a twelfth."""
        t = np.asarray(t_s, np.float64)
        return self._speed_m_s * (t + (1.0 / 12.0) / 0.35 * (1.0 - np.cos(0.35 * t)))

    def time_s(self, distance_m: float) -> float:
        """When the camera has driven `distance_m`."""
        low = distance_m / self._speed_m_s
        grid = np.linspace(max(0.0, low - 1.0), low + 0.1, 64)
        return float(np.interp(distance_m, self.distance_m(grid), grid))

    def xy(self, t_s: Floats | float) -> Floats:
        """World position on the plane, (..., 2)."""
        t = np.asarray(t_s, np.float64)
        sway = 0.12 * np.sin(0.4 * t)
        return self._road.point(self.distance_m(t), sway + self._offset_m)

    def world_from_camera(self, t_s: float) -> Floats:
        """Pose at a time, 4x4."""
        ahead, behind = self.xy(t_s + 0.01), self.xy(t_s - 0.01)
        yaw = float(np.arctan2(*(ahead - behind)[::-1]))
        pitch = np.deg2rad(0.18) * np.sin(5.1 * t_s) + np.deg2rad(0.10) * np.sin(8.7 * t_s + 1.0)
        roll = np.deg2rad(0.22) * np.sin(3.3 * t_s + 0.6)
        world_from_base = rotation_about(2, yaw) @ rotation_about(1, pitch) @ rotation_about(0, roll)
        pose = np.eye(4)
        pose[:3, :3] = world_from_base @ BASE_FROM_OPTICAL
        pose[:2, 3] = self.xy(t_s)
        pose[2, 3] = self._height_m + 0.012 * np.sin(6.3 * t_s)
        return pose
