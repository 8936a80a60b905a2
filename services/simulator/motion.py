# SPDX-License-Identifier: Apache-2.0
"""How actors move: a path through the street and a speed over time, both pure functions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from services.simulator.road import AHEAD_M, BEHIND_M, CROSS_HALF_WIDTH_M, KERB_HEIGHT_M, KERB_M, Road

Floats = NDArray[np.float64]

_KERB_STEP_M = 0.3


class SpeedProfile:
    """Speed that changes linearly between knots (seconds, metres a second) and stays beyond the outer ones."""

    def __init__(self, knots: list[tuple[float, float]]) -> None:
        self._t, self._v = (np.array(column, np.float64) for column in zip(*knots, strict=True))
        steps = 0.5 * (self._v[1:] + self._v[:-1]) * np.diff(self._t)
        self.always_still = bool(np.all(self._v == 0.0))
        self._way = np.concatenate([[0.0], np.cumsum(steps)])

    def speed_m_s(self, t_s: Floats | float) -> Floats:
        """Speed at a time."""
        return np.asarray(np.interp(t_s, self._t, self._v))

    def distance_m(self, t_s: Floats | float) -> Floats:
        """Way gone since the first knot (negative before it), exact."""
        t = np.asarray(t_s, np.float64)
        inside = np.minimum(np.maximum(t, self._t[0]), self._t[-1])
        k = np.searchsorted(self._t, inside, side="right") - 1
        since = inside - self._t[k]
        gone = self._way[k] + 0.5 * (self._v[k] + self.speed_m_s(inside)) * since
        outside = np.minimum(t - self._t[0], 0.0) * self._v[0] + np.maximum(t - self._t[-1], 0.0) * self._v[-1]
        return np.asarray(gone + outside)


class Path(Protocol):
    """A line through the street, by the distance gone along it."""

    def point(self, distance_m: Floats | float) -> Floats:
        """World position on the ground, (..., 3)."""
        ...

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        """Whether the street reaches as far."""
        ...


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
