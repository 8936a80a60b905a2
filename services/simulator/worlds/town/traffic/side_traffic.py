# SPDX-License-Identifier: Apache-2.0
"""Vehicles of the side streets: they come, go on from track to track, and leave the town."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.traffic.arrivals import Arrival
from services.simulator.worlds.town.traffic.network import TURN_M, Link, Network
from services.simulator.worlds.town.traffic.state import VehicleState
from services.simulator.worlds.town.traffic.tracks import LOOP_TRACKS

Ints = NDArray[np.intp]

_ENTRY_ROOM_M = 14.0
_CLAIM_M = TURN_M
"""No farther back, for there the traffic stands at its stop line."""
_USUAL_M_S, _AHEAD_M = 6.5, 38.0
"""Who is to meet the camera's car reaches his stop line at about this speed while it is this far away."""
_CLEARS_M = 7.0
"""A vehicle that turns off is in the way on the lane it left for so long behind its own half length."""


class SideTraffic:
    """Brings vehicles in and hands them from track to track; `first_row`: number of the first arrival."""

    def __init__(self, network: Network, arrivals: list[Arrival], first_row: int, step_s: float) -> None:
        self._arrivals, self._first_row, self._step_s = arrivals, first_row, step_s
        self._links: dict[int, Link] = {link.track: link for link in network.links}
        self._coming: list[int] = list(range(len(arrivals)))

    def step(self, state: VehicleState, rows: Ints, now_s: float, camera_free_s: float) -> None:
        """Move those on who have come to the end of their track, let in those whose time has come."""
        for row in np.flatnonzero(state.active & (state.x_m >= state.leave_x_m)).tolist():
            self._turn_off(state, row)
        side = np.flatnonzero(state.active & (state.track >= LOOP_TRACKS))
        for row in side[state.x_m[side] >= state.tracks.length_m[state.track[side]]].tolist():
            self._next_track(state, row)
        for row in side[state.beside[side] < 0].tolist():
            self._claim_lane(state, row)
        due = [number for number in self._coming if self._is_due(state, self._arrivals[number], now_s)]
        for number in due:
            arrival, row = self._arrivals[number], self._first_row + number
            there = state.active & (state.track == arrival.track)
            if bool((np.abs(state.x_m[there] - arrival.x_m) > _ENTRY_ROOM_M).all()):
                limit = state.tracks.limit_m_s(np.array([arrival.track]), np.array([arrival.x_m]))
                speed = min(float(limit[0]), 0.8 * float(state.wanted_m_s[row]))
                state.routes[row] = list(arrival.route)
                state.enter(row, round(now_s / self._step_s), arrival.track, arrival.x_m, speed)
                self._coming.remove(number)

    @staticmethod
    def _is_due(state: VehicleState, arrival: Arrival, now_s: float) -> bool:
        if arrival.meets_s_m is None:
            return arrival.time_s <= now_s
        away = (arrival.meets_s_m - state.x_m[0]) % state.tracks.length_m[0]
        takes_s = state.tracks.length_m[arrival.track] / _USUAL_M_S
        return bool(away < _AHEAD_M + takes_s * max(float(state.speed_m_s[0]), 0.5 * float(state.wanted_m_s[0])))

    def _next_track(self, state: VehicleState, row: int) -> None:
        here = int(state.track[row])
        over = float(state.x_m[row] - state.tracks.length_m[here])
        if not state.routes[row]:
            state.leave(row)
            return
        there = state.routes[row].pop(0)
        if there < LOOP_TRACKS:
            state.speed_m_s[row] /= self._stretch(state, there, self._links[here].join_x_m)
            state.beside[row], state.beside_ends_m[row] = -1, state.gone_m[row]
            state.go_on(row, there, self._links[here].join_x_m + over)
            return
        state.go_on(row, there, over)

    def _claim_lane(self, state: VehicleState, row: int) -> None:
        """Who turns onto the loop is in the way there just before, as far from the place as it still has to go."""
        link = self._links.get(int(state.track[row]))
        if link is None or link.to >= LOOP_TRACKS:
            return
        to_go = float(state.tracks.length_m[link.track] - state.x_m[row])
        if to_go < _CLAIM_M:
            state.take_room(row, link.to, link.join_x_m - float(state.tracks.length_m[link.track]), np.inf)

    def _turn_off(self, state: VehicleState, row: int) -> None:
        lane, x_m = int(state.track[row]), float(state.leave_x_m[row])
        there = state.routes[row].pop(0)
        state.speed_m_s[row] *= self._stretch(state, lane, x_m)
        over = float(state.x_m[row]) - x_m
        state.leave_x_m[row] = np.inf
        state.go_on(row, there, over)
        clear = float(state.gone_m[row]) + 0.5 * float(state.length_m[row]) + _CLEARS_M
        state.take_room(row, lane, x_m, clear)

    @staticmethod
    def _stretch(state: VehicleState, track: int, x_m: float) -> float:
        rows = np.array([track])
        return float(state.tracks.stretch(rows, state.tracks.around(rows, np.array([x_m])))[0])
