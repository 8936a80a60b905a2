# SPDX-License-Identifier: Apache-2.0
"""How actors move: a path through the world and a speed over time, both pure functions."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


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
    """A line through the world, by the distance gone along it."""

    def point(self, distance_m: Floats | float) -> Floats:
        """World position on the ground, (..., 3)."""
        ...

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        """Whether the world reaches as far."""
        ...
