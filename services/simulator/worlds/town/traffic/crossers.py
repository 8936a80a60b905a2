# SPDX-License-Identifier: Apache-2.0
"""People who wait at a zebra crossing, cross when it is theirs, turn round and wait again."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.motion import SpeedProfile
from services.simulator.worlds.town.paths import PointsPath, equally_spaced
from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import KERB_M

Floats = NDArray[np.float64]

MOST_AT_A_ZEBRA = 4
_PLACE_M = 1.0
_WAIT_N_M = KERB_M + 0.75
_TURN_RADIUS_M = 0.06
_STRAIGHT_M = 2.0 * _WAIT_N_M
_WAY_M = _STRAIGHT_M + np.pi * _TURN_RADIUS_M
_START_S = 0.6
_STEP_M = 0.05


@dataclass(slots=True)
class Crosser:
    """Somebody at zebra number `zebra`, at place `place` of it; left: whether the first wait is on the loop's left.

    look: seed of clothes and build. ready_s: from when on he wants to cross. starts_s: when he set off, each time.
    """

    zebra: int
    place: int
    left: bool
    look: int
    pace_m_s: float
    ready_s: float
    rest_s: Floats
    starts_s: list[float] = field(default_factory=list)

    def set_off(self, now_s: float) -> float:
        """Set off; returns when he is over and has turned."""
        self.starts_s.append(now_s)
        over = now_s + _WAY_M / self.pace_m_s + _START_S
        self.ready_s = over + float(self.rest_s[len(self.starts_s) % len(self.rest_s)])
        return over

    def speed(self, end_s: float) -> SpeedProfile:
        """Speed over all crossings; who has not crossed by `end_s` does so after it: he is not one who never moves."""
        knots = [(0.0, 0.0)]
        for start in self.starts_s:
            over = start + _WAY_M / self.pace_m_s + _START_S
            knots += [(start, 0.0), (start + _START_S, self.pace_m_s), (over - _START_S, self.pace_m_s), (over, 0.0)]
        knots += [(end_s, 0.0), (end_s + 1.0, self.pace_m_s)] if len(knots) == 1 else [(knots[-1][0] + 1.0, 0.0)]
        return SpeedProfile(knots)

    def path(self, plan: TownPlan) -> PointsPath:
        """Across, round, back and round again."""
        bend = np.linspace(0.0, np.pi, 9)[1:-1]
        way = np.arange(-_WAIT_N_M, _WAIT_N_M + 1e-9, 0.5)
        r = _TURN_RADIUS_M
        along = np.concatenate([np.full_like(way, -r), -r * np.cos(bend), np.full_like(way, r), r * np.cos(bend)])
        across = np.concatenate([way, way[-1] + r * np.sin(bend), way[::-1], way[0] - r * np.sin(bend)])
        if self.left:
            along, across = -along, -across
        s = plan.zebras_m[self.zebra] + (self.place - 0.5 * (MOST_AT_A_ZEBRA - 1)) * _PLACE_M + along
        points = plan.loop.point(np.append(s, s[0]), np.append(across, across[0]))
        spaced, step_m = equally_spaced(points, _STEP_M)
        return PointsPath(spaced, step_m, plan.ground, closed=True)


def draw_crossers(rng: np.random.Generator, zebras: int, traffic: float) -> list[Crosser]:
    """Who wants to cross where, and when; more of them where more moves."""
    crossers = []
    for zebra in range(zebras):
        wanted = min(MOST_AT_A_ZEBRA, int(rng.poisson(1.2 + 2.2 * traffic)))
        places = rng.permutation(MOST_AT_A_ZEBRA)
        first = float(rng.uniform(0.5, 16.0))
        for place in places[:wanted] if traffic > 0.0 else []:
            rest = rng.uniform(12.0, 34.0, 16) * (1.3 - 0.3 * traffic)
            ready = first + float(rng.uniform(0.0, 4.0))
            pace = float(rng.uniform(1.5, 2.0))
            left, look = bool(rng.random() < 0.5), int(rng.integers(0, 2**31))
            crossers.append(Crosser(zebra, int(place), left, look, pace, ready, rest))
    return crossers
