# SPDX-License-Identifier: Apache-2.0
"""Junctions: who comes along a side street waits at the stop line for a gap, or for a light when none comes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import SIDE_KERB_M
from services.simulator.worlds.town.traffic.network import Link, Network
from services.simulator.worlds.town.traffic.sites import Site, SiteState
from services.simulator.worlds.town.traffic.state import VehicleState

Ints = NDArray[np.intp]

_LOOKS_M = 9.0
"""Who is this near to the end of the side street looks for a gap."""
_LINE_M = 1.2
"""Bumpers stop this far ahead of the end of the side street's track, where turns begin."""
_PATIENCE_S = 9.0
_FLOW_S = 50.0
_CAMERA_REST_S, _CAMERA_NEAR_M = 36.0, 70.0
_STANDS_M_S = 0.3
_LIGHT_TRAFFIC = 0.15
_COMING_M, _TEMPTING = (22.0, 44.0), (0.5, 0.0)
_REST_S = 6.0
"""After others have crossed, the loop goes on for so long at least."""
_FOLLOW_S = 4.0
"""So long after the first one others follow him straight on."""
_ROOM_M = 14.0
_SLOW_M_S = 2.5
_DECIDE_M = (32.0, 46.0)
_TURN_OFF_SHARE = 0.16
_TURN_BRAKE_M_S2 = 1.4
_HALF_M = SIDE_KERB_M + 1.2
_TURN_BACK_M = 4.0
"""Room that a turn onto the loop wants behind where it ends."""


class Junction:
    """One crossing of the loop with its side streets."""

    def __init__(
        self, plan: TownPlan, network: Network, number: int, *, vehicles: int, traffic: float, seed: int
    ) -> None:
        s_m = plan.crossings[number].s_m
        self.site = Site(s_m - _HALF_M, s_m + _HALF_M, vehicles)
        self._arms = [k for k, arm in enumerate(network.arms) if arm.crossing == number]
        self._network, self._number, self._seed = network, number, seed
        self._links = {link.track: link for link in network.links if link.arm in self._arms}
        self._off = [link for link in self._links.values() if link.move == "off"]
        self._has_light, self._traffic = traffic >= _LIGHT_TRAFFIC, traffic
        self._waits_since: dict[int, float] = {}
        self._released: set[int] = set()
        self._decided: set[int] = set()

    def step(self, state: VehicleState, rows: Ints, now_s: float, camera_free_s: float) -> None:
        """Open, close, let vehicles through."""
        site = self.site
        fronts = self._fronts(state, now_s)
        if site.state is SiteState.OPEN and fronts:
            self._ask(state, rows, fronts, now_s, camera_free_s)
        if site.state is SiteState.CLOSING:
            if fronts and site.is_empty(state, rows) and not self._inside(state) and self._has_room(state, fronts[0]):
                site.change(SiteState.CROSSED, now_s)
                self._released = {fronts[0]}
            elif site.gave_up(now_s):
                site.change(SiteState.OPEN, now_s)
        elif site.state is SiteState.CROSSED:
            self._released &= set(np.flatnonzero(state.active).tolist())
            if not site.needs_room and now_s - site.since_s < _FOLLOW_S and self._only_straight(state, fronts):
                self._released |= {row for row in fronts if self._has_room(state, row)}
            waiting = [row for row in self._released if state.track[row] in self._tracks_in()]
            if not waiting and not self._inside(state):
                self._released.clear()
                site.change(SiteState.OPEN, now_s)
        site.hold(state, rows)
        site.keep_clear(state, rows)
        self._hold_side(state, fronts)
        self._turn_off(state, rows)

    def _tracks_in(self) -> list[int]:
        return [self._network.arms[k].track_in for k in self._arms]

    def _link(self, state: VehicleState, row: int) -> Link:
        return self._links[state.routes[row][0]]

    def _only_straight(self, state: VehicleState, fronts: list[int]) -> bool:
        """Whether all who are on their way over and all who want to are going straight on."""
        inside = np.flatnonzero(state.active & np.isin(state.track, list(self._links)))
        links = [self._links[int(track)] for track in state.track[inside]]
        links += [self._link(state, row) for row in self._released if state.track[row] in self._tracks_in()]
        return all(link.move == "straight" for link in [*links, *(self._link(state, row) for row in fronts)])

    def _fronts(self, state: VehicleState, now_s: float) -> list[int]:
        """The first vehicle of each side street that is near its end, longest waiting first."""
        found = []
        for track in self._tracks_in():
            there = np.flatnonzero(state.active & (state.track == track))
            if not len(there):
                continue
            row = int(there[np.argmax(state.x_m[there])])
            if state.tracks.length_m[track] - state.x_m[row] - 0.5 * state.length_m[row] < _LOOKS_M:
                self._waits_since.setdefault(row, now_s)
                found.append(row)
        return sorted(found, key=lambda row: (self._waits_since[row], row))

    def _inside(self, state: VehicleState) -> bool:
        """Whether anybody is between the stop lines on the side streets' ways."""
        return bool((state.active & np.isin(state.track, list(self._links))).any())

    def _ask(self, state: VehicleState, rows: Ints, fronts: list[int], now_s: float, camera_free_s: float) -> None:
        """Close when the longest waiting one has a gap or has waited long enough."""
        row = fronts[0]
        link = self._link(state, row)
        arm = self._network.arms[link.arm]
        if (
            (link.move != "straight" and not self.site.is_alone())
            or now_s - self.site.since_s < _REST_S
            or not self._has_room(state, row, slow_only=True)
        ):
            return
        ways = (arm.way,) if link.move == "right" else (0, 1)
        camera_m = float(self.site.ahead_m(state, np.zeros(1, np.intp))[0])
        impatient = now_s - self._waits_since[row] > _PATIENCE_S and now_s - self.site.since_s > _FLOW_S
        rested = now_s - camera_free_s > _CAMERA_REST_S
        stands = state.speed_m_s[0] < _STANDS_M_S and link.move == "straight"
        light = impatient and (rested or stands or camera_m > _CAMERA_NEAR_M)
        # Now and then the light turns just when the camera comes.
        light |= rested and _COMING_M[0] < camera_m < _COMING_M[1] and self._tempted(row)
        light &= self._has_light
        if light or self.site.gap_for_all(state, rows, ways):
            self.site.close(state, rows, now_s, ways)
            self.site.needs_room = link.move != "straight"

    def _tempted(self, row: int) -> bool:
        draw = np.random.default_rng([self._seed, 50, row, self._number]).random()
        return bool(draw < _TEMPTING[0] + _TEMPTING[1] * self._traffic)

    def _has_room(self, state: VehicleState, row: int, *, slow_only: bool = False) -> bool:
        """Whether the way that a vehicle wants to take is free at its end; slow_only: of those who stay."""
        link = self._link(state, row)
        target, x_m = state.on_track(link.to)
        counts = (target != row) & ((state.speed_m_s[target] < _SLOW_M_S) | (not slow_only))
        x_m, target = x_m[counts], target[counts]
        if link.move == "straight":
            rear = x_m - 0.5 * state.length_m[target]
            return not bool((rear < _ROOM_M - 6.0).any())
        round_m = state.tracks.length_m[link.to]
        offset = (x_m - link.join_x_m + 0.5 * round_m) % round_m - 0.5 * round_m
        reach = 0.5 * (state.length_m[target] + state.length_m[row])
        return not bool(((offset > -_TURN_BACK_M - reach) & (offset < _ROOM_M + reach)).any())

    def _hold_side(self, state: VehicleState, fronts: list[int]) -> None:
        """Who is not released stops at the line; nobody drives into whom he followed."""
        for row in fronts:
            track = state.track[row]
            end = state.tracks.length_m[track] - 0.5 * state.length_m[row]
            if row not in self._released:
                state.gate_m[row] = max(0.05, end - _LINE_M - state.x_m[row])
            for link in self._links.values():
                if link.move != "off" and self._network.arms[link.arm].track_in == track:
                    for other in np.flatnonzero(state.active & (state.track == link.track)):
                        rear = float(state.x_m[other] - 0.5 * state.length_m[other])
                        state.gate_m[row] = min(state.gate_m[row], max(0.05, end + rear - state.x_m[row]))

    def _turn_off(self, state: VehicleState, rows: Ints) -> None:
        """Some on the outer lane leave the loop here."""
        for link in self._off:
            track = 2 * self._network.arms[link.arm].way + 1
            round_m = state.tracks.length_m[track]
            lane = rows[(state.track[rows] == track) & (state.beside[rows] < 0) & state.overtakes[rows]]
            ahead = (link.leave_x_m - state.x_m[lane]) % round_m
            for row, away in zip(lane.tolist(), ahead.tolist(), strict=True):
                if _DECIDE_M[0] < away < _DECIDE_M[1] and row not in self._decided and not state.routes[row]:
                    self._decided.add(row)
                    rng = np.random.default_rng([self._seed, 48, row, self._number])
                    if rng.random() < _TURN_OFF_SHARE:
                        state.routes[row] = [link.track, link.to]
                        state.leave_x_m[row] = state.x_m[row] + away
                if state.routes[row] and state.routes[row][0] == link.track and away < _DECIDE_M[1]:
                    slow = float(state.tracks.limit_m_s(np.array([link.track]), np.zeros(1))[0])
                    state.cap_m_s[row] = np.sqrt(slow * slow + 2.0 * _TURN_BRAKE_M_S2 * away)
                    if self.site.state is not SiteState.OPEN:
                        state.gate_m[row] = min(state.gate_m[row], max(0.05, away))
