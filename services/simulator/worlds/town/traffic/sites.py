# SPDX-License-Identifier: Apache-2.0
"""Where the loop's traffic has to let others cross: closed when somebody wants to, crossed only when it is empty."""

from __future__ import annotations

from enum import Enum

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.traffic.state import VehicleState
from services.simulator.worlds.town.traffic.tracks import LOOP_TRACKS

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

STOP_AHEAD_M = 1.0
"""Stop lines lie this far ahead of what is crossed."""
_COMFORT_M_S2 = 2.5
_MILD_M_S2 = 0.8
_REACTION_S = 1.0
_GOING_M = 12.0
"""Who stands nearer than this is about to go, too."""
_SIGHT_M = 110.0
_ROLLED_M, _ROLLS_M_S = 0.7, 1.0
_NEIGHBOUR_M = 40.0
_SLOW_M_S, _QUEUE_M, _SPACING_M = 1.0, 30.0, 2.2
_CLEARING_S = 6.0
"""A site whose cars do not get away within this is opened again."""


class SiteState(Enum):
    """open: traffic flows; closing: it stops, who is too near goes through; crossed: it stands, others cross."""

    OPEN = "open"
    CLOSING = "closing"
    CROSSED = "crossed"


class Site:
    """A stretch of the loop, s from `low_m` to `high_m`, that others cross; both ways stop ahead of it."""

    def __init__(self, low_m: float, high_m: float, vehicles: int) -> None:
        self.middle_m = 0.5 * (low_m + high_m)
        self._reach_m = 0.5 * (high_m - low_m) + STOP_AHEAD_M
        self.state = SiteState.OPEN
        self.needs_room = True
        self.since_s = -np.inf
        self.busy_until_s = -np.inf
        self._neighbours: list[Site] = []
        self._ways: tuple[int, ...] = (0, 1)
        self._passes = np.zeros(vehicles, bool)
        """Who was too near to stop and goes through."""

    def know(self, sites: list[Site], round_m: float) -> None:
        """Learn which of the other sites are so near that who turns there could not stop here."""
        for site in sites:
            apart = abs((site.middle_m - self.middle_m + 0.5 * round_m) % round_m - 0.5 * round_m)
            if apart < _NEIGHBOUR_M:
                self._neighbours.append(site)

    def is_alone(self) -> bool:
        """Whether nobody next to it needs, or might turn into, the room ahead of its stop lines."""
        return all(site.state is SiteState.OPEN or not site.needs_room for site in self._neighbours)

    def change(self, state: SiteState, now_s: float) -> None:
        """Go into another state."""
        self.state, self.since_s = state, now_s

    def ahead_m(self, state: VehicleState, rows: Ints) -> Floats:
        """Road from the bumpers of vehicles on the loop to their stop line, up to a whole round."""
        line = np.where(state.track[rows] < LOOP_TRACKS // 2, self.middle_m, -self.middle_m) - self._reach_m
        front = state.x_m[rows] + 0.5 * state.length_m[rows]
        return np.asarray((line - front) % state.tracks.length_m[0])

    def inside(self, state: VehicleState, rows: Ints) -> NDArray[np.bool_]:
        """Whether any part of a vehicle is between the stop lines."""
        ahead, round_m = self.ahead_m(state, rows), state.tracks.length_m[0]
        return np.asarray(round_m - ahead < 2.0 * self._reach_m + state.length_m[rows])

    def gap_for_all(self, state: VehicleState, rows: Ints, ways: tuple[int, ...] = (0, 1)) -> bool:
        """Whether nobody of these ways would have to brake for it."""
        rows = _going(state, rows, ways)
        if self.inside(state, rows).any():
            return False
        speed = state.speed_m_s[rows]
        needed = speed * speed / (2.0 * _MILD_M_S2) + _REACTION_S * speed + _GOING_M
        return bool((self.ahead_m(state, rows) > needed).all())

    def close(self, state: VehicleState, rows: Ints, now_s: float, ways: tuple[int, ...] = (0, 1)) -> None:
        """Stop the traffic of these ways, as far as it can."""
        self._ways = ways
        speed = state.speed_m_s[rows]
        self._passes[:] = False
        self._passes[rows] = self.ahead_m(state, rows) < speed * speed / (2.0 * _COMFORT_M_S2) + 0.3 * speed
        self.change(SiteState.CLOSING, now_s)

    def keep_clear(self, state: VehicleState, rows: Ints) -> None:
        """Hold whoever would come to stand inside, for want of room between those ahead of him behind the site."""
        round_m, zone_m = state.tracks.length_m[0], 2.0 * self._reach_m
        ahead = self.ahead_m(state, rows)
        past = round_m - ahead
        slow = (state.speed_m_s[rows] < _SLOW_M_S) & (past < zone_m + _QUEUE_M)
        for track in np.unique(state.track[rows[slow]]).tolist():
            mine = state.track[rows] == track
            queued = mine & slow
            back = float((past - state.length_m[rows])[queued].min())
            between = mine & (past < back + state.length_m[rows]) & ~queued
            room = back - zone_m - float((state.length_m[rows][between] + _SPACING_M).sum())
            coming = np.flatnonzero(mine & (ahead < _QUEUE_M))
            if len(coming):
                first = coming[np.argmin(ahead[coming])]
                row = rows[first]
                if room < state.length_m[row] + _SPACING_M:
                    state.gate_m[row] = min(state.gate_m[row], float(ahead[first]))

    def is_empty(self, state: VehicleState, rows: Ints) -> bool:
        """Whether everybody who could not stop is through."""
        rows = _going(state, rows, self._ways)
        coming = self._passes[rows] & (self.ahead_m(state, rows) < _SIGHT_M)
        return not bool((self.inside(state, rows) | coming).any())

    def gave_up(self, now_s: float) -> bool:
        """Whether the traffic did not get away in time."""
        return self.state is SiteState.CLOSING and now_s - self.since_s > _CLEARING_S

    def hold(self, state: VehicleState, rows: Ints) -> None:
        """Let those who can stop see the line."""
        if self.state is SiteState.OPEN:
            return
        rows = _going(state, rows, self._ways)
        ahead = self.ahead_m(state, rows)
        # Who rolled over his line by a hand's breadth still stands ahead of what is crossed.
        over = (state.tracks.length_m[0] - ahead < _ROLLED_M) & (state.speed_m_s[rows] < _ROLLS_M_S)
        held = ((ahead < _SIGHT_M) | over) & ~self._passes[rows]
        gate = np.where(over, 0.0, ahead)
        state.gate_m[rows[held]] = np.minimum(state.gate_m[rows[held]], gate[held])


def _going(state: VehicleState, rows: Ints, ways: tuple[int, ...]) -> Ints:
    """Those of some vehicles on the loop that go one of these ways."""
    return rows if len(ways) == 2 else rows[state.track[rows] // 2 == ways[0]]
