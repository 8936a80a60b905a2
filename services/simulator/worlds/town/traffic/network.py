# SPDX-License-Identifier: Apache-2.0
"""The side streets as tracks: in and out along each, across to the opposite one, and turns from and onto the loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.paths import equally_spaced
from services.simulator.worlds.town.plan import Line, TownPlan
from services.simulator.worlds.town.profile import LANE_CENTRES_M, SIDE_LANE_CENTRE_M, SIDE_STOP_M
from services.simulator.worlds.town.traffic.tracks import LOOP_TRACKS, Track, line_track

Floats = NDArray[np.float64]

Move = Literal["straight", "right", "left", "off"]
"""Over the loop, onto it, or off it to the right."""

TURN_M = 10.0
"""Turns meet the loop's lane this far beside the junction's middle."""
_MOUTH_M = SIDE_STOP_M - 0.5
"""Where turns meet the side street's lane."""
_STEP_M = 0.25
_REACH_M = 110.0
_JOINED_M = 1.5
_SIDE_SPEED_M_S = 8.0
_ROUND = 1.25
"""How far tangents reach, in half lengths of the chord; rounds the turn off."""


@dataclass(frozen=True, slots=True)
class Arm:
    """A side street as seen from crossing number `crossing`; way: that of the loop's near lanes.

    track_in, track_out: its lanes. joined: the arm that it runs into at its far end, None where it leads away.
    """

    crossing: int
    way: int
    track_in: int
    track_out: int
    joined: int | None


@dataclass(frozen=True, slots=True)
class Link:
    """A way through the junction from an arm (`off`: from the loop) as a track of its own.

    to: the track that it ends on. join_x_m: x there; leave_x_m: x on the loop where a turn off begins.
    """

    move: Move
    arm: int
    track: int
    to: int
    join_x_m: float
    leave_x_m: float = 0.0


class Network:
    """All arms and links; `tracks` follow the loop's own, `points` are theirs with the steps between them."""

    def __init__(self, plan: TownPlan) -> None:
        self._plan = plan
        self.tracks: list[Track] = []
        self.points: list[tuple[Floats, float]] = []
        lines: list[tuple[int, int, Line]] = []
        for number, crossing in enumerate(plan.crossings):
            for way, line in ((0, crossing.right), (1, crossing.left)):
                if line is not None and line.length_m > _MOUTH_M + 15.0:
                    lines.append((number, way, line))
        self.arms: list[Arm] = []
        for number, way, line in lines:
            other = self._joined(line, [other for _, _, other in lines])
            reach = line.length_m if other is not None else min(_REACH_M, line.length_m)
            inwards = line.point(np.arange(reach, _MOUTH_M - 1e-6, -_STEP_M), SIDE_LANE_CENTRE_M)
            outwards = line.point(np.arange(_MOUTH_M, reach + 1e-6, _STEP_M), -SIDE_LANE_CENTRE_M)
            self.arms.append(Arm(number, way, self._add(inwards), self._add(outwards), other))
        self.links: list[Link] = []
        for number, arm in enumerate(self.arms):
            self._link(number, arm)

    def _link(self, number: int, arm: Arm) -> None:
        s_m = self._plan.crossings[arm.crossing].s_m
        for other in self.arms:
            if other.crossing == arm.crossing and other.way != arm.way:
                track = self._bent(self._end(arm.track_in), self._begin(other.track_out))
                self.links.append(Link("straight", number, track, other.track_out, 0.0))
        for move, way, lane in (("right", arm.way, 1), ("left", 1 - arm.way, 0)):
            x_m = (s_m if way == 0 else -s_m) + TURN_M
            track = self._bent(self._end(arm.track_in), self._on_loop(way, lane, x_m))
            self.links.append(Link("right" if move == "right" else "left", number, track, 2 * way + lane, x_m))
        if arm.joined is None:
            x_m = (s_m if arm.way == 0 else -s_m) - TURN_M
            track = self._bent(self._on_loop(arm.way, 1, x_m), self._begin(arm.track_out))
            self.links.append(Link("off", number, track, arm.track_out, 0.0, x_m))

    def _add(self, points: Floats) -> int:
        spaced, step_m = equally_spaced(points, _STEP_M)
        track = line_track(spaced, step_m)
        slow = np.minimum(track.limit_m_s, _SIDE_SPEED_M_S)
        self.tracks.append(Track(track.length_m, False, track.arc_m, slow, track.curvature))
        self.points.append((spaced, step_m))
        return LOOP_TRACKS + len(self.tracks) - 1

    def _bent(self, leave: tuple[Floats, Floats], arrive: tuple[Floats, Floats]) -> int:
        """Cubic Hermite curve between two places with directions."""
        (a, from_a), (b, to_b) = leave, arrive
        reach = _ROUND * float(np.linalg.norm(b - a))
        t = np.linspace(0.0, 1.0, 65)[:, None]
        ends = (1.0 + 2.0 * t) * (1.0 - t) ** 2 * a + t * t * (3.0 - 2.0 * t) * b
        return self._add(np.asarray(ends + reach * (t * (1.0 - t) ** 2 * from_a - t * t * (1.0 - t) * to_b)))

    def _begin(self, track: int) -> tuple[Floats, Floats]:
        points = self.points[track - LOOP_TRACKS][0]
        return points[0], (points[1] - points[0]) / np.linalg.norm(points[1] - points[0])

    def _end(self, track: int) -> tuple[Floats, Floats]:
        points = self.points[track - LOOP_TRACKS][0]
        return points[-1], (points[-1] - points[-2]) / np.linalg.norm(points[-1] - points[-2])

    def _on_loop(self, way: int, lane: int, x_m: float) -> tuple[Floats, Floats]:
        ahead = 1.0 if way == 0 else -1.0
        n = -ahead * LANE_CENTRES_M[lane]
        at, later = self._plan.loop.point(ahead * np.array([x_m, x_m + 0.05]), n)
        return at, (later - at) / np.linalg.norm(later - at)

    @staticmethod
    def _joined(line: Line, lines: list[Line]) -> int | None:
        """Number of the line that ends where this one ends."""
        end = line.point(line.length_m, 0.0)
        for number, other in enumerate(lines):
            if other is not line and np.linalg.norm(other.point(other.length_m, 0.0) - end) < _JOINED_M:
                return number
        return None
