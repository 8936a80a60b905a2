# SPDX-License-Identifier: Apache-2.0
"""The lanes that vehicles follow one another in, each with a coordinate x of its own that grows as they drive.

The loop's four lanes are closed tracks: x = s for those who drive with s, x = -s for those against it, so that the
lanes of one direction share their coordinate. Side streets are open tracks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import LANE_CENTRES_M

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

LOOP_TRACKS = 4
"""Tracks of the loop: 2 * way + lane; way 0 drives with s, way 1 against it; lane 0 is the inner one."""
_GRID_M = 0.5
_LATERAL_M_S2 = 1.9
"""Planned in corners; what is felt stays below 2.5."""
_BRAKE_M_S2 = 1.2
_FAST_M_S = 40.0
_WINDOW_M = 4.0


@dataclass(frozen=True, slots=True)
class Track:
    """arc_m, limit_m_s: (K + 1,) at equal steps of x over `length_m`: length of the lane itself since x = 0, and the
    speed that its corners allow, in x. curvature: (K + 1,) of the centre line, 1/m, unsigned."""

    length_m: float
    closed: bool
    arc_m: Floats
    limit_m_s: Floats
    curvature: Floats


class Tracks:
    """All tracks, looked up for many vehicles at once."""

    def __init__(self, tracks: list[Track]) -> None:
        self.length_m = np.array([track.length_m for track in tracks])
        self.closed = np.array([track.closed for track in tracks])
        self._steps = np.array([len(track.arc_m) - 1 for track in tracks])
        self._first = np.cumsum([0] + [len(track.arc_m) for track in tracks])[:-1]
        self._arc = np.concatenate([track.arc_m for track in tracks])
        self._limit = np.concatenate([track.limit_m_s for track in tracks])
        self._curvature = np.concatenate([track.curvature for track in tracks])
        self.round_arc_m = np.array([track.arc_m[-1] for track in tracks])

    def around(self, track: Ints, x: Floats) -> Floats:
        """x brought into the first round of closed tracks."""
        return np.asarray(np.where(self.closed[track], x % self.length_m[track], x))

    def arc_m(self, track: Ints, around: Floats) -> Floats:
        """Length of the lane since x = 0, for x within the first round."""
        low, fraction = self._place(track, around)
        return np.asarray(self._arc[low] + fraction * (self._arc[low + 1] - self._arc[low]))

    def stretch(self, track: Ints, around: Floats) -> Floats:
        """Metres of lane a metre of x."""
        low, _ = self._place(track, around)
        return np.asarray((self._arc[low + 1] - self._arc[low]) * (self._steps[track] / self.length_m[track]))

    def limit_m_s(self, track: Ints, around: Floats) -> Floats:
        """Highest speed in x there, corners ahead considered."""
        low, fraction = self._place(track, around)
        return np.asarray(self._limit[low] + fraction * (self._limit[low + 1] - self._limit[low]))

    def curvature(self, track: Ints, around: Floats) -> Floats:
        """Of the centre line, 1/m, unsigned."""
        low, _ = self._place(track, around)
        return np.asarray(self._curvature[low])

    def _place(self, track: Ints, around: Floats) -> tuple[Ints, Floats]:
        at = around * (self._steps[track] / self.length_m[track])
        index = np.minimum(np.maximum(at.astype(np.intp), 0), self._steps[track] - 1)
        return self._first[track] + index, np.minimum(np.maximum(at - index, 0.0), 1.0)


def loop_tracks(plan: TownPlan) -> list[Track]:
    """The four lanes of the loop."""
    length = plan.loop.length_m
    count = int(np.ceil(length / _GRID_M))
    s = np.linspace(0.0, length, count + 1)
    tracks = []
    for way in (0, 1):
        x = s if way == 0 else -s
        # Curvature as a car feels it, over a few metres: a heading sampled in steps has no derivative of its own.
        kappa = (plan.loop.heading(x + 0.5 * _WINDOW_M) - plan.loop.heading(x - 0.5 * _WINDOW_M)) / _WINDOW_M
        for lane in (0, 1):
            n = LANE_CENTRES_M[lane] * (1.0 if way else -1.0)
            points = plan.loop.point(x, n)
            arc = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
            stretch = np.maximum(1.0 - kappa * n, 0.3)
            sharp = np.maximum(np.abs(kappa) / stretch, _LATERAL_M_S2 / _FAST_M_S**2)
            limit = np.sqrt(_LATERAL_M_S2 / sharp) / stretch
            tracks.append(Track(length, True, arc, _braked(limit, length / count, closed=True), np.abs(kappa)))
    return tracks


def line_track(points: Floats, step_m: float) -> Track:
    """An open track through world points (P, 2) at equal distances."""
    heading = np.unwrap(np.arctan2(*np.diff(points, axis=0).T[::-1]))
    window = max(1, round(_WINDOW_M / step_m))
    sharp = np.zeros(len(points))
    bend = np.abs(heading[window:] - heading[:-window]) / (window * step_m)
    sharp[window // 2 + 1 : window // 2 + 1 + len(bend)] = bend
    limit = np.sqrt(_LATERAL_M_S2 / np.maximum(sharp, _LATERAL_M_S2 / _FAST_M_S**2))
    arc = np.asarray(np.arange(len(points)) * step_m, np.float64)
    return Track(float(arc[-1]), False, arc, _braked(limit, step_m, closed=False), sharp)


def _braked(limit: Floats, step_m: float, *, closed: bool) -> Floats:
    """The limit lowered ahead of corners, so that braking gently is enough."""
    rounds = np.concatenate([limit[:-1], limit]) if closed else limit.copy()
    for k in range(len(rounds) - 2, -1, -1):
        rounds[k] = min(rounds[k], np.sqrt(rounds[k + 1] ** 2 + 2.0 * _BRAKE_M_S2 * step_m))
    result: Floats = rounds[: len(limit)]
    if closed:
        result[-1] = result[0]
    return result
