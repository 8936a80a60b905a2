# SPDX-License-Identifier: Apache-2.0
"""Roughly where everybody is, so that only those who may be in sight are asked exactly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.actor import Actor

Floats = NDArray[np.float64]

_STEP_S = 0.5
_STEPS = 64
"""Positions are worked out for so many steps at a time: for one it costs as much."""
_FASTEST_M_S = 30.0
"""Nobody is faster; a position is at most half a step old or early."""
_OUTSIDE_M = 12.0
"""Longest half of a vehicle."""


@dataclass(frozen=True, slots=True)
class Reach:
    """How far an upright camera looks: `range_m`, within `slope` (x / z) of its axis, and `around_m` to all sides."""

    range_m: float
    slope: float
    around_m: float


class Whereabouts:
    """Positions of actors at even times, worked out when they are asked for.

    actors: those who may move. Never leaves out anybody within reach.
    """

    def __init__(self, actors: Sequence[Actor]) -> None:
        self._actors = actors
        self._first_step = -1
        self._positions = np.zeros((0, _STEPS, 2))

    def perhaps_in_sight(self, world_from_camera: Floats, t_s: float, reach: Reach) -> NDArray[np.intp]:
        """Numbers of actors whose middle may be within reach."""
        away = self._at(int(np.rint(t_s / _STEP_S))) - world_from_camera[:2, 3]
        margin = 0.5 * _STEP_S * _FASTEST_M_S + _OUTSIDE_M
        ahead = away @ world_from_camera[:2, 2]
        beside = np.abs(away @ world_from_camera[:2, 0])
        in_range = np.hypot(away[:, 0], away[:, 1]) < reach.range_m + margin
        in_view = (ahead > -margin) & (beside < reach.slope * np.maximum(ahead, 0.0) + margin)
        around = np.hypot(away[:, 0], away[:, 1]) < reach.around_m + margin
        return np.flatnonzero((in_range & in_view) | around)

    def _at(self, step: int) -> Floats:
        """Positions (A, 2) at one even time."""
        first = step - step % _STEPS
        if first != self._first_step:
            t_s = _STEP_S * np.arange(first, first + _STEPS, dtype=np.float64)
            found = [actor.path.point(actor.speed.distance_m(t_s))[:, :2] for actor in self._actors]
            self._first_step, self._positions = first, np.array(found, np.float64).reshape(-1, _STEPS, 2)
        return self._positions[:, step - first]
