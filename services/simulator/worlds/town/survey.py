# SPDX-License-Identifier: Apache-2.0
"""The town before anything is built: streets, junctions, zebra crossings and the shape of the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.options import DriveOptions
from services.simulator.worlds.line import SampledLine
from services.simulator.worlds.town.carriageways import DistanceMap
from services.simulator.worlds.town.ground import Hills, TownGround
from services.simulator.worlds.town.loop import Loop, town_loop
from services.simulator.worlds.town.plan import Crossing, TownPlan
from services.simulator.worlds.town.profile import CROSSING_CLEAR_M
from services.simulator.worlds.town.side_streets import BEYOND_M, Mouth, SideStreet, SideStreetPlanner

Floats = NDArray[np.float64]

_ZEBRA_GAP_M = 120.0
_STRAIGHT_ENOUGH = 1.0 / 90.0


@dataclass(frozen=True, slots=True)
class TownSurvey:
    """plan: what traffic needs to know. loop, streets: what houses stand along. centre, radius_m: a circle round it."""

    plan: TownPlan
    loop: Loop
    streets: tuple[SideStreet, ...]
    ground: TownGround
    centre: Floats
    radius_m: float

    @property
    def mouths(self) -> list[tuple[Mouth, SideStreet, bool]]:
        """All openings of side streets into the loop; whether it is the street's far end."""
        return [
            (mouth, street, far)
            for street in self.streets
            for mouth, far in ((street.begin, False), (street.end, True))
            if mouth is not None
        ]


def survey_town(options: DriveOptions) -> TownSurvey:
    """The whole survey; what stands follows from it and the seed alone."""
    loop = town_loop(options.seed, options.loop_m)
    rng = np.random.default_rng([options.seed, 21])
    streets = tuple(SideStreetPlanner(loop, rng).plan())
    lines: list[tuple[SampledLine, float]] = [
        (street.line, street.line.length_m + (0.0 if street.end else BEYOND_M)) for street in streets
    ]
    tracks = [(loop.line, loop.line.length_m), *lines]
    samples = [(line, np.arange(0.0, length_m, 2.0)) for line, length_m in tracks]
    points = np.concatenate([line.point(s, 0.0) for line, s in samples])
    heading = np.concatenate([line.heading(s) for line, s in samples])
    low, high = points.min(axis=0), points.max(axis=0)
    centre, radius_m = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
    hills = Hills(np.random.default_rng([options.seed, 22]), centre, radius_m)
    hills.scaled_to(points, np.stack([np.cos(heading), np.sin(heading)], axis=1), options.max_slope)
    ground = TownGround(hills, DistanceMap(low, high, loop.line, lines))
    crossings = _crossings(streets)
    plan = TownPlan(loop.line, crossings, _zebras(loop, crossings, rng), ground)
    return TownSurvey(plan, loop, streets, ground, centre, radius_m)


def _crossings(streets: tuple[SideStreet, ...]) -> list[Crossing]:
    """Junctions by s; a street that joins two of them is shared half and half."""
    arms: dict[float, dict[float, SampledLine]] = {}
    for street in streets:
        if street.end is None:
            arms.setdefault(street.begin.s_m, {})[street.begin.side] = street.line
            continue
        half_m = 0.5 * street.line.length_m
        arms.setdefault(street.begin.s_m, {})[street.begin.side] = street.line.part(half_m)
        arms.setdefault(street.end.s_m, {})[street.end.side] = street.line.part(half_m, from_end=True)
    return [Crossing(s, sides.get(1.0), sides.get(-1.0)) for s, sides in sorted(arms.items())]


def _zebras(loop: Loop, crossings: list[Crossing], rng: np.random.Generator) -> list[float]:
    """Places of zebra crossings by s: on straight pieces, beside junctions and halfway along streets."""
    length_m = loop.line.length_m
    wanted = [crossing.s_m + float(rng.choice([-16.0, 16.0])) for crossing in crossings]
    wanted += [0.5 * (street.start_m + street.end_m) for street in loop.streets]
    found: list[float] = []
    # Where none of these will do, anywhere along a street.
    spare = [st.start_m + u * (st.end_m - st.start_m) for st in loop.streets for u in (0.3, 0.7, 0.15, 0.85)]
    for s in np.concatenate([rng.permutation(np.array(wanted)), spare]) % length_m:
        bend = np.abs(loop.line.curvature(s + np.linspace(-10.0, 10.0, 9))).max()
        others = [*found, *(crossing.s_m for crossing in crossings), 0.0]
        gaps = [abs((s - other + 0.5 * length_m) % length_m - 0.5 * length_m) for other in others]
        limits = [_ZEBRA_GAP_M] * len(found) + [CROSSING_CLEAR_M] * len(crossings) + [30.0]
        if bend < _STRAIGHT_ENOUGH and all(gap >= limit for gap, limit in zip(gaps, limits, strict=True)):
            found.append(float(s))
    return sorted(found)
