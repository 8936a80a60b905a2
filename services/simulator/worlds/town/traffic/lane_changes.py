# SPDX-License-Identifier: Apache-2.0
"""Who changes lanes: MOBIL (Kesting, Treiber, Helbing 2007), for the two lanes of each way of the loop."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.paths import Shift
from services.simulator.worlds.town.profile import LANE_WIDTH_M
from services.simulator.worlds.town.traffic.car_following import following_acceleration
from services.simulator.worlds.town.traffic.state import Order, VehicleState
from services.simulator.worlds.town.traffic.tracks import LOOP_TRACKS

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

_EVERY = 5
"""A driver looks every so many steps."""
_POLITENESS = 0.2
_THRESHOLD_M_S2 = 0.25
_TO_OUTER_M_S2 = 0.12
_SAFE_M_S2 = -2.0
_LEAST_SPEED_M_S = 2.0
_STRAIGHT = 1.0 / 80.0
_REST_M = 25.0
"""Way between two changes of one vehicle."""
_GATE_M = 35.0


class LaneChanges:
    """Lets vehicles change lanes; `barred` is a lane that nobody changes into, -1: none."""

    def __init__(self, state: VehicleState, barred: int) -> None:
        self._state, self._barred = state, barred

    def step(self, number: int, order: Order, acceleration: Floats) -> None:
        """Begin and end changes. acceleration: (N,) of each vehicle behind its leaders, stop lines apart."""
        state = self._state
        gone = state.gone_m
        ended = (state.beside >= 0) & (gone > state.beside_ends_m)
        state.beside[ended] = -1
        rows = self._candidates(number, gone)
        for track in range(LOOP_TRACKS):
            if track != self._barred:
                self._into(track, rows[state.track[rows] == (track ^ 1)], order, acceleration, gone)

    def _candidates(self, number: int, gone: Floats) -> Ints:
        state = self._state
        able = state.active & state.overtakes & (state.beside < 0) & (state.track < LOOP_TRACKS)
        able &= (gone > state.beside_ends_m + _REST_M) & (state.speed_m_s > _LEAST_SPEED_M_S)
        able &= (state.gate_m > _GATE_M) & np.isinf(state.leave_x_m)
        able[np.arange(len(able)) % _EVERY != number % _EVERY] = False
        rows = np.flatnonzero(able)
        for ahead_m in (0.0, 12.0, 24.0):
            at = state.tracks.around(state.track[rows], state.x_m[rows] + ahead_m)
            rows = rows[state.tracks.curvature(state.track[rows], at) < _STRAIGHT]
        return rows

    def _into(self, track: int, rows: Ints, order: Order, acceleration: Floats, gone: Floats) -> None:
        """The one change into `track` that gains the most, if any is safe and worth it."""
        state = self._state
        if not len(rows):
            return
        there = slice(order.first[track], order.first[track + 1])
        others, arcs = order.row[there], order.arc_m[there]
        gain = acceleration[rows] * -1.0
        own = state.drivers.take(rows)
        wanted = np.minimum(
            state.wanted_m_s[rows], state.tracks.limit_m_s(np.full(len(rows), track), state.around_m[rows])
        )
        speed = state.speed_m_s[rows]
        if not len(others):
            new = following_acceleration(own, speed, wanted, np.full(len(rows), np.inf), speed)
            safe = np.ones(len(rows), bool)
        else:
            arc = state.tracks.arc_m(np.full(len(rows), track), state.around_m[rows])
            k = np.searchsorted(arcs, arc)
            round_m = state.tracks.round_arc_m[track]
            leader, follower = others[k % len(others)], others[k - 1]
            half = 0.5 * state.length_m[rows]
            gap = (arcs[k % len(others)] - arc) % round_m - half - 0.5 * state.length_m[leader]
            gap_behind = (arc - arcs[k - 1]) % round_m - half - 0.5 * state.length_m[follower]
            new = following_acceleration(own, speed, wanted, gap, state.speed_m_s[leader])
            theirs = following_acceleration(
                state.drivers.take(follower),
                state.speed_m_s[follower],
                state.wanted_m_s[follower],
                gap_behind,
                speed,
            )
            faster = np.maximum(state.speed_m_s[follower] - speed, 0.0)
            safe = (gap > 2.0 + 0.3 * speed) & (gap_behind > 2.5 + 0.3 * speed + 1.5 * faster)
            safe &= (theirs > _SAFE_M_S2) & (new > _SAFE_M_S2)
            gain += _POLITENESS * np.minimum(theirs - acceleration[follower], 0.0)
        gain += new - _THRESHOLD_M_S2 + (_TO_OUTER_M_S2 if track % 2 else -_TO_OUTER_M_S2)
        gain[~safe] = -np.inf
        best = int(np.argmax(gain))
        if gain[best] > 0.0:
            self._begin(int(rows[best]), track, float(gone[rows[best]]))

    def _begin(self, row: int, track: int, gone_m: float) -> None:
        state = self._state
        length = max(16.0, 3.2 * float(state.speed_m_s[row]))
        outwards = 1.0 if track % 2 else -1.0
        right = -1.0 if track < 2 else 1.0
        state.shifts[row].append(Shift(gone_m, length, outwards * right * LANE_WIDTH_M))
        state.take_room(row, int(state.track[row]), 0.0, gone_m + length)
        state.track[row] = track
