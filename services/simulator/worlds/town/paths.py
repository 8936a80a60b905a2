# SPDX-License-Identifier: Apache-2.0
"""Lines that actors of the town follow: along the loop, and through points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.motion import Path
from services.simulator.worlds.town.plan import Ground, TownPlan

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Shift:
    """A change of offset by `by_m` (left of the loop positive) over `length_m` from `begin_m` of the way gone on."""

    begin_m: float
    length_m: float
    by_m: float


@dataclass(frozen=True, slots=True)
class Sway:
    """A sine across the way, by the way gone."""

    amplitude_m: float
    wave_m: float
    phase_rad: float


class LoopPath:
    """Along the loop from `s_m` in `direction` (+1 or -1) at offset `n_m`, with shifts on the way.

    The way gone is counted along the centre line, so that all lanes share one coordinate. sway: nobody drives as on
    rails. leeway: (K,) further offset at equal steps of s over one round.
    """

    def __init__(
        self,
        plan: TownPlan,
        direction: float,
        s_m: float,
        n_m: float,
        *,
        shifts: tuple[Shift, ...] = (),
        sway: Sway | None = None,
        leeway: Floats | None = None,
    ) -> None:
        self._plan, self._direction, self._s_m, self._n_m = plan, direction, s_m, n_m
        self._shifts = np.array([(shift.begin_m, shift.length_m, shift.by_m) for shift in shifts]).reshape(-1, 3)
        self._sway, self._leeway = sway, leeway

    def point(self, distance_m: Floats | float) -> Floats:
        """World position on the ground, (..., 3)."""
        gone = np.asarray(distance_m, np.float64)
        s = self._s_m + self._direction * gone
        n = self._n_m + self._shifted(gone)
        if self._leeway is not None:
            n = n + _round_table(self._leeway, s / self._plan.loop.length_m)
        if self._sway is not None:
            n = n + self._sway.amplitude_m * np.sin(gone * (2.0 * np.pi / self._sway.wave_m) + self._sway.phase_rad)
        plane = self._plan.loop.point(s, n)
        return np.concatenate([plane, self._plan.ground.height_m(plane)[..., None]], axis=-1)

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        """Everywhere."""
        return np.ones(np.shape(distance_m), bool)

    def _shifted(self, gone: Floats) -> Floats:
        if not len(self._shifts):
            return np.zeros_like(gone)
        begin, length, by = self._shifts.T
        x = np.minimum(np.maximum((gone[..., None] - begin) / length, 0.0), 1.0)
        return np.asarray((by * x * x * x * (10.0 + x * (6.0 * x - 15.0))).sum(axis=-1))


class PointsPath:
    """Along a line of world points (P, 2) at equal distances `step_m`; a closed one is gone round and round.

    `from_m`: where on the line the way begins. An open line goes straight on beyond its ends, where nobody is present.
    """

    def __init__(self, points: Floats, step_m: float, ground: Ground, *, from_m: float = 0.0, closed: bool = False):
        self._xy, self._step_m, self._ground = points, step_m, ground
        self._from_m, self._closed = from_m, closed

    @property
    def length_m(self) -> float:
        """Length of the line."""
        return self._step_m * (len(self._xy) - 1)

    def begun_at(self, from_m: float) -> PointsPath:
        """The same line, its way begun elsewhere."""
        return PointsPath(self._xy, self._step_m, self._ground, from_m=from_m, closed=self._closed)

    def point(self, distance_m: Floats | float) -> Floats:
        """World position on the ground, (..., 3)."""
        at = (self._from_m + np.asarray(distance_m, np.float64)) / self._step_m
        last = len(self._xy) - 1
        if self._closed:
            at = at % last
        index = np.minimum(np.maximum(at.astype(np.intp), 0), last - 1)
        fraction = (at - index)[..., None]
        plane = self._xy[index] + fraction * (self._xy[index + 1] - self._xy[index])
        return np.concatenate([plane, self._ground.height_m(plane)[..., None]], axis=-1)

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        """Whether the line reaches as far."""
        at = (self._from_m + np.asarray(distance_m, np.float64)) / self._step_m
        return np.asarray(self._closed | ((at >= 0.0) & (at < len(self._xy) - 1)))


class ChainPath:
    """One path after another; begins_m: (K,) way gone where each begins, the first at 0; each is asked for its own way.

    Nobody is present before the begin, nor from `end_m` on.
    """

    def __init__(self, paths: Sequence[Path], begins_m: Sequence[float], end_m: float) -> None:
        self._paths, self._begins_m, self._end_m = tuple(paths), np.asarray(begins_m, np.float64), end_m

    def point(self, distance_m: Floats | float) -> Floats:
        """World position on the ground, (..., 3)."""
        gone = np.asarray(distance_m, np.float64)
        number = np.maximum(np.searchsorted(self._begins_m, gone, side="right") - 1, 0)
        points = np.empty((*gone.shape, 3))
        for k in np.unique(number):
            mine = number == k
            points[mine] = self._paths[k].point(gone[mine] - self._begins_m[k])
        return points

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        """Whether the actor is there after this way."""
        gone = np.asarray(distance_m, np.float64)
        return np.asarray((gone >= 0.0) & (gone < self._end_m))


@dataclass(frozen=True, slots=True)
class StraightPath:
    """From a world point (2,) on in one direction; what stands there stands on the ground."""

    xy: Floats
    heading_rad: float
    ground: Ground

    def point(self, distance_m: Floats | float) -> Floats:
        """World position on the ground, (..., 3)."""
        ahead = np.array([np.cos(self.heading_rad), np.sin(self.heading_rad)])
        plane = self.xy + np.asarray(distance_m, np.float64)[..., None] * ahead
        return np.concatenate([plane, self.ground.height_m(plane)[..., None]], axis=-1)

    def inside(self, distance_m: Floats | float) -> NDArray[np.bool_]:
        """Everywhere."""
        return np.ones(np.shape(distance_m), bool)


def equally_spaced(points: Floats, step_m: float) -> tuple[Floats, float]:
    """Points (P, 2) of a line again at equal distances near `step_m`; also returns that distance."""
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    count = max(2, int(np.ceil(way[-1] / step_m)) + 1)
    at = np.linspace(0.0, way[-1], count)
    return np.column_stack([np.interp(at, way, points[:, axis]) for axis in (0, 1)]), float(at[1])


def _round_table(table: Floats, turns: Floats) -> Floats:
    """Value at parts of a round, linear between the entries of a table that repeats."""
    at = turns % 1.0 * len(table)
    low = at.astype(np.intp) % len(table)
    return np.asarray(table[low] + (at - np.floor(at)) * (table[(low + 1) % len(table)] - table[low]))
