# SPDX-License-Identifier: Apache-2.0
"""How the robot carries the camera round the loop."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.runtime.errors import InputError
from services.simulator.actors.placement import BASE_FROM_OPTICAL, rotation_about
from services.simulator.options import DriveOptions
from services.simulator.worlds.corridor.plan import HALF_WIDTH_M, FloorPlan

Floats = NDArray[np.float64]

MAX_OFFSET_M = 0.25
MAX_SPEED_M_S = 3.0
_IN_CORNERS = 0.5
"""Share of the speed that is left in a corner."""
_HALF_LENGTH_M = 0.25


class RobotPath:
    """Two driven axles half a metre apart on the loop; slower in corners.

    Raises:
        InputError: a speed or an offset that the corridor is too narrow for.
    """

    def __init__(self, options: DriveOptions, plan: FloorPlan) -> None:
        if options.speed_m_s > MAX_SPEED_M_S:
            raise InputError(
                f"simulator speed_m_s={options.speed_m_s}: expected at most {MAX_SPEED_M_S:g} in a corridor"
            )
        if abs(options.lateral_offset_m) > MAX_OFFSET_M:
            expected = f"{-MAX_OFFSET_M:g} to {MAX_OFFSET_M:g} in a corridor"
            raise InputError(f"simulator lateral_offset_m={options.lateral_offset_m}: expected {expected}")
        self._line, self._n_m = plan.line, options.lateral_offset_m
        self._height_m, self._start_m = options.camera_height_m, options.start_m
        s = np.linspace(0.0, self._line.length_m, round(40.0 * self._line.length_m) + 1)
        window = np.array([-0.6, -0.3, 0.0, 0.3, 0.6])
        bend = np.abs(self._line.curvature(s[:, None] + window)).mean(axis=1) * HALF_WIDTH_M
        speed = options.speed_m_s * (1.0 - (1.0 - _IN_CORNERS) * bend)
        steps = np.diff(s) * 0.5 * (1.0 / speed[1:] + 1.0 / speed[:-1])
        self._s, self._t = s, np.concatenate([[0.0], np.cumsum(steps)])
        self._start_s = float(np.interp(self._start_m % self._line.length_m, self._s, self._t))

    def s_m(self, t_s: Floats | float) -> Floats:
        """Way along the loop's centre, counted on over its rounds."""
        at = self._start_s + np.asarray(t_s, np.float64)
        laps = np.floor(at / self._t[-1])
        return np.asarray(np.interp(at - laps * self._t[-1], self._t, self._s) + laps * self._line.length_m)

    def world_from_camera(self, t_s: float) -> Floats:
        """Pose at a time, 4x4, with the small shake of hard wheels."""
        s = float(self.s_m(t_s))
        rear, front = self._line.point(s + np.array([-_HALF_LENGTH_M, _HALF_LENGTH_M]), self._n_m)
        yaw = float(np.arctan2(*(front - rear)[::-1]))
        pitch = np.deg2rad(0.12) * np.sin(9.1 * t_s) + np.deg2rad(0.08) * np.sin(13.7 * t_s + 1.0)
        pose = np.eye(4)
        pose[:3, :3] = rotation_about(2, yaw) @ rotation_about(1, pitch) @ BASE_FROM_OPTICAL
        pose[:2, 3] = 0.5 * (rear + front)
        pose[2, 3] = self._height_m + 0.004 * np.sin(11.3 * t_s)
        return pose
