# SPDX-License-Identifier: Apache-2.0
"""How the camera rides in its car."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.motion import Path, SpeedProfile
from services.simulator.actors.placement import BASE_FROM_OPTICAL, axle_pose, rotation_about
from services.simulator.worlds.town.traffic.population import CAMERA_AHEAD_M

Floats = NDArray[np.float64]

_HALF_BASE_M = 1.3
_ROLLING_M_S = 4.0
"""From this speed on the car sways with its whole amplitude; standing it does not."""


class CarCamera:
    """Pose of a camera that is fixed to a car on its axles, with the small pitch, roll and bounce of its springs."""

    def __init__(self, path: Path, speed: SpeedProfile, height_m: float) -> None:
        self._path, self._speed, self._height_m = path, speed, height_m

    def distance_m(self, t_s: Floats | float) -> Floats:
        """Way driven along the loop's centre line since the start."""
        return self._speed.distance_m(t_s)

    def speed_m_s(self, t_s: Floats | float) -> Floats:
        """Speed along the loop's centre line."""
        return self._speed.speed_m_s(t_s)

    def world_from_camera(self, t_s: float) -> Floats:
        """Pose at a time, 4x4; camera optical, world as in `plan`."""
        gone = float(self._speed.distance_m(t_s))
        rear, front = self._path.point(gone + np.array([-_HALF_BASE_M, _HALF_BASE_M]))
        world_from_car = axle_pose(rear, front)
        rolling = min(1.0, float(self._speed.speed_m_s(t_s)) / _ROLLING_M_S)
        pitch = rolling * (np.deg2rad(0.18) * np.sin(5.1 * t_s) + np.deg2rad(0.10) * np.sin(8.7 * t_s + 1.0))
        roll = rolling * np.deg2rad(0.22) * np.sin(3.3 * t_s + 0.6)
        bounce = rolling * 0.012 * np.sin(6.3 * t_s)
        pose = np.eye(4)
        pose[:3, :3] = world_from_car[:3, :3] @ rotation_about(1, pitch) @ rotation_about(0, roll) @ BASE_FROM_OPTICAL
        pose[:3, 3] = world_from_car[:3, :3] @ [CAMERA_AHEAD_M, 0.0, self._height_m + bounce] + world_from_car[:3, 3]
        return pose
