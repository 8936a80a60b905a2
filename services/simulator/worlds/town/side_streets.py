# SPDX-License-Identifier: Apache-2.0
"""Side streets: where they leave the loop, and where they lead."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.line import SampledLine, line_through
from services.simulator.worlds.town.loop import Loop

Floats = NDArray[np.float64]

BEYOND_M = 40.0
"""How far a free street goes on behind the end of its line."""

_FREE_M = (135.0, 165.0)
_JOINING_M = (64.0, 260.0)
_STRAIGHT_M = 26.0
"""Straight at the junction, so that kerbs meet at right angles."""
_APART_M = 46.0
_CROSSING_GAP_M = 44.0
_START_GAP_M = 24.0
_STRAIGHT_ENOUGH = 1.0 / 60.0
_MOST_SLANTED_RAD = 0.6


@dataclass(frozen=True, slots=True)
class Mouth:
    """Where a side street opens into the loop: to its left (side +1) or right (-1) at `s_m`."""

    s_m: float
    side: float


@dataclass(frozen=True, slots=True)
class SideStreet:
    """line: from the loop's centre line outwards. begin: its mouth; end: the mouth where it meets the loop again, or
    None where it leads out of the town, `BEYOND_M` farther than the line."""

    line: SampledLine
    begin: Mouth
    end: Mouth | None


class SideStreetPlanner:
    """Draws side streets one after another; each must keep clear of all before it."""

    def __init__(self, loop: Loop, rng: np.random.Generator) -> None:
        self._loop, self._rng = loop, rng
        self._samples_m = np.arange(0.0, loop.line.length_m, 2.0)
        self._samples = loop.line.point(self._samples_m, 0.0)
        self.streets: list[SideStreet] = []

    def plan(self) -> list[SideStreet]:
        """Streets that cut through the blocks, then those that go on at corners, then others wherever there is room."""
        loop_m = self._loop.line.length_m
        for street in self._loop.streets:
            for share in self._rng.uniform(0.25, 0.75, 2):
                s = (street.start_m + share * (street.end_m - street.start_m)) % loop_m
                side = float(self._rng.choice([-1.0, 1.0]))
                self._try(Mouth(float(s), side), self._joining)
                self._try(Mouth(float(s), -side), self._joining)
        for mouth in self._mouths():
            if self._rng.random() < 0.7:
                self._try(Mouth(mouth.s_m, -mouth.side), self._free)
        for street in self._loop.streets:
            if self._rng.random() < 0.85:
                outside = -1.0 if street.turn_rad > 0 else 1.0
                self._try(Mouth(street.corner_m % loop_m, outside), partial(self._free, corner=street.turn_rad))
        for street in self._loop.streets:
            length_m = street.end_m - street.start_m
            for share in (0.5,) if length_m < 130.0 else (0.3, 0.68):
                s = (street.start_m + (share + self._rng.uniform(-0.05, 0.05)) * length_m) % loop_m
                for side in self._rng.permutation([-1.0, 1.0]):
                    if self._rng.random() < 0.75:
                        self._try(Mouth(float(s), float(side)), self._free)
        return self.streets

    def _try(self, mouth: Mouth, draw: Callable[[Mouth, float], SideStreet | None]) -> bool:
        if self._spacing_m(mouth) < _CROSSING_GAP_M or self._around(mouth.s_m) < _START_GAP_M:
            return False
        street = draw(mouth, float(self._loop.line.heading(mouth.s_m)) + 0.5 * np.pi * mouth.side)
        if street is None or not self._keeps_clear(street):
            return False
        self.streets.append(street)
        return True

    def _spacing_m(self, mouth: Mouth) -> float:
        """Distance to the nearest other junction; one straight across the loop is the same junction."""
        gaps = [self._around(mouth.s_m - other.s_m) for other in self._mouths()]
        same = [other for other in self._mouths() if other.s_m == mouth.s_m and other.side != mouth.side]
        return min((gap for gap in gaps if not (same and gap == 0.0)), default=np.inf)

    def _mouths(self) -> list[Mouth]:
        return [mouth for street in self.streets for mouth in (street.begin, street.end) if mouth is not None]

    def _around(self, ds_m: float) -> float:
        length_m = self._loop.line.length_m
        return abs((ds_m + 0.5 * length_m) % length_m - 0.5 * length_m)

    def _joining(self, mouth: Mouth, heading: float) -> SideStreet | None:
        """To another street of the loop straight ahead, where there is one near enough and square enough."""
        origin = self._loop.line.point(mouth.s_m, 0.0)
        ahead = np.array([np.cos(heading), np.sin(heading)])
        away = self._samples - origin
        along, beside = away @ ahead, away @ np.array([-ahead[1], ahead[0]])
        hits = np.flatnonzero((along > 30.0) & (along < _JOINING_M[1]) & (np.abs(beside) < 3.0))
        if not len(hits):
            return None
        s = float(self._samples_m[hits[np.argmin(along[hits])]])
        arriving = np.array([np.cos(h := float(self._loop.line.heading(s))), np.sin(h)])
        side = 1.0 if float(arriving[0] * -ahead[1] - arriving[1] * -ahead[0]) > 0.0 else -1.0
        end = Mouth(s, side)
        inwards = h + 0.5 * np.pi * side + np.pi
        slant = abs((inwards - heading + np.pi) % (2.0 * np.pi) - np.pi)
        bend = np.abs(self._loop.line.curvature(s + np.linspace(-14.0, 14.0, 15))).max()
        if slant > _MOST_SLANTED_RAD or bend > _STRAIGHT_ENOUGH or self._around(s) < _START_GAP_M:
            return None
        if self._spacing_m(end) < _CROSSING_GAP_M:
            return None
        goal = self._loop.line.point(s, 0.0)
        if not _JOINING_M[0] < float(np.linalg.norm(goal - origin)) < _JOINING_M[1]:
            return None
        return SideStreet(_smooth_join(origin, heading, goal, inwards), mouth, end)

    def _free(self, mouth: Mouth, heading: float, corner: float | None = None) -> SideStreet:
        """Out of the town; at a corner that turns by `corner` it takes the direction of a street that meets there."""
        length_m = float(self._rng.uniform(*_FREE_M))
        if corner is None:
            turn = float(self._rng.uniform(-0.5, 0.5))
        else:
            turn = mouth.side * (0.5 * np.pi - 0.5 * abs(corner)) * float(self._rng.choice([-1.0, 1.0]))
        s = np.linspace(0.0, length_m, round(length_m / 0.5) + 1)
        u = np.clip((s - _STRAIGHT_M) / 60.0, 0.0, 1.0)
        bent = heading + turn * (u - np.sin(2.0 * np.pi * u) / (2.0 * np.pi))
        return SideStreet(SampledLine(bent, length_m, self._loop.line.point(mouth.s_m, 0.0)), mouth, None)

    def _keeps_clear(self, street: SideStreet) -> bool:
        reach_m = street.line.length_m + (0.0 if street.end else BEYOND_M)
        s = np.arange(0.0, reach_m, 4.0)
        points = street.line.point(s, 0.0)
        own = np.minimum(s, np.inf if street.end is None else street.line.length_m - s)
        # Near its mouths a street is as far from the loop as it has come; farther out it must be well away.
        wanted = np.minimum(0.8 * own, _APART_M)
        if (_nearest_m(points, self._samples) < wanted).any():
            return False
        for other in self.streets:
            others = other.line.point(np.arange(12.0, other.line.length_m + (0.0 if other.end else BEYOND_M), 4.0), 0.0)
            if (_nearest_m(points, others) < np.minimum(0.8 * own, 0.85 * _APART_M)).any():
                return False
        return True


def _nearest_m(points: Floats, others: Floats) -> Floats:
    return np.asarray(np.linalg.norm(points[:, None] - others[None], axis=-1).min(axis=1))


def _smooth_join(start: Floats, heading: float, goal: Floats, end_heading: float) -> SampledLine:
    """Straight away from both junctions and a cubic curve between."""
    leaving = np.array([np.cos(heading), np.sin(heading)])
    arriving = np.array([np.cos(end_heading), np.sin(end_heading)])
    a, b = start + _STRAIGHT_M * leaving, goal - _STRAIGHT_M * arriving
    reach = np.linalg.norm(b - a) / 3.0
    u = np.linspace(0.0, 1.0, 400)[:, None]
    weights = ((1 - u) ** 3, 3 * u * (1 - u) ** 2, 3 * u * u * (1 - u), u**3)
    curve = weights[0] * a + weights[1] * (a + reach * leaving) + weights[2] * (b - reach * arriving) + weights[3] * b
    straight = np.linspace(0.0, 1.0, 60)[:-1, None]
    return line_through(
        np.concatenate([start + straight * (a - start), curve, (b + straight * (goal - b))[1:], [goal]])
    )
