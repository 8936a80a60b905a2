# SPDX-License-Identifier: Apache-2.0
"""How a driver follows: the intelligent driver model (Treiber, Hennecke, Helbing 2000) with the mild reaction to speeds
above the wanted one of its improved form (Treiber and Kesting, Traffic Flow Dynamics, 2013, section 11.3.7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

HARDEST_M_S2 = 8.0
"""Brakes give no more."""
_LEAST_GAP_M = 0.05
_NO_LEADER_M = 1e6


@dataclass(frozen=True, slots=True)
class Drivers:
    """What drivers want; every column (N,): comfortable acceleration and braking, m/s2, time gap, s, gap when
    standing, m."""

    accelerate_m_s2: Floats
    brake_m_s2: Floats
    time_gap_s: Floats
    standing_gap_m: Floats

    def take(self, rows: NDArray[np.intp]) -> Drivers:
        """Some of them."""
        return Drivers(
            self.accelerate_m_s2[rows], self.brake_m_s2[rows], self.time_gap_s[rows], self.standing_gap_m[rows]
        )


def free_acceleration(drivers: Drivers, speed_m_s: Floats, wanted_m_s: Floats) -> Floats:
    """Acceleration on an empty road, (N,)."""
    a, b = drivers.accelerate_m_s2, drivers.brake_m_s2
    ratio = speed_m_s / np.maximum(wanted_m_s, 0.1)
    faster = a * (1.0 - ratio**4)
    slower = -b * (1.0 - np.maximum(ratio, 1.0) ** (-4.0 * a / b))
    return np.where(ratio <= 1.0, faster, slower)


def following_acceleration(
    drivers: Drivers, speed_m_s: Floats, wanted_m_s: Floats, gap_m: Floats, leader_m_s: Floats
) -> Floats:
    """Acceleration behind a leader, (N,); gap_m is free road between bumpers, infinite where there is no leader."""
    free = free_acceleration(drivers, speed_m_s, wanted_m_s)
    a = drivers.accelerate_m_s2
    closing = speed_m_s * (speed_m_s - leader_m_s) / (2.0 * np.sqrt(a * drivers.brake_m_s2))
    wanted_gap = drivers.standing_gap_m + np.maximum(0.0, speed_m_s * drivers.time_gap_s + closing)
    ratio = wanted_gap / np.clip(gap_m, _LEAST_GAP_M, _NO_LEADER_M)
    close = a * (1.0 - ratio * ratio) + np.minimum(free, 0.0)
    power = 2.0 * a / np.maximum(free, 1e-3)
    far = np.where(free > 0.0, free * (1.0 - np.minimum(ratio, 1.0) ** power), free)
    return np.maximum(np.where(ratio >= 1.0, close, far), -HARDEST_M_S2)
