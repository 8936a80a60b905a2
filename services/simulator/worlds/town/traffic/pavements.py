# SPDX-License-Identifier: Apache-2.0
"""People on the pavements: some walk to and fro, some stand and look or talk."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.motion import Path, SpeedProfile
from services.simulator.options import DriveOptions
from services.simulator.worlds.town.paths import PointsPath, StraightPath, equally_spaced
from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import CORNER_RADIUS_M, KERB_M, PAVEMENT_EDGE_M, SIDE_KERB_M

Floats = NDArray[np.float64]

_LANES_M = (KERB_M + 1.65, KERB_M + 2.43)
_STANDING_N_M = PAVEMENT_EDGE_M - 0.34
_STRETCH_M = 46.0
_LEAST_M = 8.0
_APART_M = 1.6
_STEP_M = 0.1
_APART_ENDS_M = 1.2
_STRAIGHT_ENOUGH = 0.85
_STANDING_PER_M = 0.012
_TALKING = 0.4


@dataclass(frozen=True, slots=True)
class Pedestrian:
    """Somebody on a pavement; look: seed of clothes and build."""

    path: Path
    speed: SpeedProfile
    look: int


def pedestrians(plan: TownPlan, options: DriveOptions) -> list[Pedestrian]:
    """All of them, stretch by stretch."""
    found: list[Pedestrian] = []
    for way in (0, 1):
        for number, (first, last) in enumerate(_stretches(plan, way)):
            rng = np.random.default_rng([options.seed_of_traffic, 44, way, number])
            found += _walkers(plan, options, rng, (way, first, last))
            found += _standing(plan, rng, (way, first, last))
    return found


def walking_per_m(traffic: float) -> float:
    """Walkers on a metre of one pavement."""
    return 0.012 + 0.11 * traffic


def _stretches(plan: TownPlan, way: int) -> list[tuple[float, float]]:
    """Pieces of the pavement without side streets in between, s from and to."""
    clear = SIDE_KERB_M + CORNER_RADIUS_M + 0.8
    mouths = [c.s_m for c in plan.crossings if (c.right if way == 0 else c.left) is not None]
    if not mouths:
        mouths, clear = [0.0], 0.5
    pieces = []
    for first, last in zip(mouths, [*mouths[1:], mouths[0] + plan.loop.length_m], strict=True):
        low, high = first + clear, last - clear
        count = max(1, round((high - low) / _STRETCH_M))
        cuts = np.linspace(low, high, count + 1)
        room = [0.5 * _APART_ENDS_M / _width(plan, way, float(cut)) for cut in cuts]
        ends = zip(pairwise(cuts), pairwise(room), strict=True)
        pieces += [(float(a) + before, float(b) - after) for (a, b), (before, after) in ends]
    return [piece for piece in pieces if piece[1] - piece[0] > _LEAST_M]


def _width(plan: TownPlan, way: int, s_m: float) -> float:
    """Metres of pavement a metre of s: fewer on the inside of a bend."""
    turn = float(plan.loop.heading(s_m + 2.0) - plan.loop.heading(s_m - 2.0)) / 4.0
    return max(0.25, 1.0 - turn * _LANES_M[1] * (1.0 if way else -1.0))


def _walkers(
    plan: TownPlan, options: DriveOptions, rng: np.random.Generator, where: tuple[int, float, float]
) -> list[Pedestrian]:
    """They share their pace, so that nobody catches up with anybody."""
    way, first, last = where
    count = int(rng.poisson(walking_per_m(options.traffic) * (last - first))) if options.traffic > 0.0 else 0
    count = min(count, int((last - first) / _APART_M))
    if not count:
        return []
    path = _circuit(plan, 1.0 if way else -1.0, first, last, clockwise=bool(rng.random() < 0.5))
    pace = float(rng.uniform(1.0, 1.65))
    speed = SpeedProfile([(0.0, pace), (1.0, pace)])
    room = rng.uniform(0.3, 1.7, count)
    free = path.length_m - _APART_M * count
    begins = np.cumsum(_APART_M + free * room / room.sum())
    looks = rng.integers(0, 2**31, count)
    return [Pedestrian(path.begun_at(float(at)), speed, int(look)) for at, look in zip(begins, looks, strict=True)]


def _circuit(plan: TownPlan, side: float, first: float, last: float, *, clockwise: bool) -> PointsPath:
    """Along one lane of the pavement and back along the other."""
    near, far = _LANES_M
    r = 0.5 * (far - near)
    bend = np.linspace(0.0, np.pi, 13)[1:-1]
    along = np.arange(first + r, last - r, 0.4)
    s = np.concatenate([along, last - r + r * np.sin(bend), along[::-1], first + r - r * np.sin(bend)])
    n = np.concatenate(
        [np.full_like(along, near), near + r - r * np.cos(bend), np.full_like(along, far), near + r + r * np.cos(bend)]
    )
    points = plan.loop.point(np.append(s, s[0]), side * np.append(n, n[0]))
    spaced, step_m = equally_spaced(points[::-1] if clockwise else points, _STEP_M)
    return PointsPath(spaced, step_m, plan.ground, closed=True)


def _standing(plan: TownPlan, rng: np.random.Generator, where: tuple[int, float, float]) -> list[Pedestrian]:
    """Alone, facing the street or along it, or two who talk."""
    way, first, last = where
    side = 1.0 if way else -1.0
    found: list[Pedestrian] = []
    still = SpeedProfile([(0.0, 0.0), (1.0, 0.0)])
    places = max(0, int((last - first) / 3.0))
    for place in range(places):
        if rng.random() > 3.0 * _STANDING_PER_M:
            continue
        s = first + 3.0 * (place + 0.5)
        if _width(plan, way, s) < _STRAIGHT_ENOUGH:
            continue
        talking = rng.random() < _TALKING
        spots = [(-0.5, 0.0), (0.5, np.pi)] if talking else [(0.0, float(rng.choice([0.0, 0.5, 1.0])) * np.pi)]
        along = float(plan.loop.heading(s))
        for at, turn in spots:
            heading = along - side * turn
            xy = plan.loop.point(s, side * _STANDING_N_M) + at * np.array([np.cos(along), np.sin(along)])
            found.append(Pedestrian(StraightPath(xy, heading, plan.ground), still, int(rng.integers(0, 2**31))))
    return found
