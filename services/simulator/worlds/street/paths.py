# SPDX-License-Identifier: Apache-2.0
"""Lines that actors follow through the street."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.street.road import AHEAD_M, BEHIND_M, CROSS_HALF_WIDTH_M, KERB_HEIGHT_M, KERB_M, Road

Floats = NDArray[np.float64]

_KERB_STEP_M = 0.3


@dataclass(frozen=True, slots=True)
class LanePath:
    """Along the road from `s_m` in `direction` (+1 or -1), sliding from offset `n_from_m` to `n_to_m` in `merge_m`."""

    road: Road
    s_m: float
    direction: float
    n_from_m: float
    n_to_m: float
    merge_m: float = 9.0

    def point(self, distance_m: Floats | float) -> Floats:
        gone = np.asarray(distance_m, np.float64)
        x = np.minimum(np.maximum(gone / self.merge_m, 0.0), 1.0)
        n = self.n_from_m + (self.n_to_m - self.n_from_m) * x * x * (3.0 - 2.0 * x)
        s = self.s_m + self.direction * gone
        return np.concatenate([self.road.point(s, n), ground_height_m(self.road, s, n)[..., None]], axis=-1)

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        s = self.s_m + self.direction * np.asarray(distance_m, np.float64)
        return (s > 5.0 - BEHIND_M) & (s < self.road.length_m + AHEAD_M - 5.0)


@dataclass(frozen=True, slots=True)
class AcrossPath:
    """Straight across the road at `s_m`, from offset `n_from_m` towards the other side (`direction` of n)."""

    road: Road
    s_m: float
    n_from_m: float
    direction: float

    def point(self, distance_m: Floats | float) -> Floats:
        n = self.n_from_m + self.direction * np.asarray(distance_m, np.float64)
        s = np.full_like(n, self.s_m)
        return np.concatenate([self.road.point(s, n), ground_height_m(self.road, s, n)[..., None]], axis=-1)

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        return np.abs(self.n_from_m + self.direction * np.asarray(distance_m, np.float64)) < 105.0


def ground_height_m(road: Road, s: Floats, n: Floats) -> Floats:
    """Height of the ground: the kerbs are walked up and down over 0.3 m, crossing streets lie low."""
    away = [(np.abs(n) - KERB_M)] + [np.abs(s - junction) - CROSS_HALF_WIDTH_M for junction in road.junctions_m]
    up = np.min(away, axis=0) / _KERB_STEP_M + 0.5
    return np.asarray(KERB_HEIGHT_M * np.minimum(np.maximum(up, 0.0), 1.0))
