# SPDX-License-Identifier: Apache-2.0
"""All vehicles at one moment of the simulation, in columns, and who follows whom."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.paths import Shift
from services.simulator.worlds.town.traffic.fleet import Vehicle, drivers_of
from services.simulator.worlds.town.traffic.tracks import LOOP_TRACKS, Tracks

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Order:
    """Places of vehicles on tracks, sorted by track and way; who changes lanes has a place in both.

    row: (P,) number of the vehicle. track, arc_m: (P,). gap_m, leader: (P,) free road ahead and the vehicle there;
    infinite and the vehicle itself where there is none. first: (tracks + 1,) where each track's places begin.
    """

    row: Ints
    track: Ints
    arc_m: Floats
    gap_m: Floats
    leader: Ints
    first: Ints


@dataclass(frozen=True, slots=True)
class Leg:
    """A stretch of a vehicle's way on one track: x where it begins, and the way gone until there."""

    track: int
    x_m: float
    gone_m: float


class VehicleState:
    """Columns over all vehicles (N,), those included who have not come yet or are gone.

    x_m: middle of the vehicle on its track. gone_m: way since it came, enter_step: when. beside: a second track it
    takes room on, -1: none, until beside_ends_m of its way; beside_dx_m: x there less x_m. gate_m: road to what holds
    it. cap_m_s: speed that a turn ahead allows. routes: tracks still to take. left: gone for good.
    """

    def __init__(self, vehicles: list[Vehicle], tracks: Tracks) -> None:
        count = len(vehicles)
        self.tracks = tracks
        self.drivers = drivers_of(vehicles)
        self.length_m = np.array([v.length_m for v in vehicles])
        self.wanted_m_s = np.array([v.wanted_m_s for v in vehicles])
        self.overtakes = np.array([not v.keeps_lane for v in vehicles])
        self.track = np.zeros(count, np.intp)
        self.beside = np.full(count, -1, np.intp)
        self.beside_dx_m, self.beside_ends_m = np.zeros(count), np.full(count, -np.inf)
        self.x_m, self.speed_m_s, self.gone_m = np.zeros(count), np.zeros(count), np.zeros(count)
        self.around_m = np.zeros(count)
        self.active = np.zeros(count, bool)
        self.left = np.zeros(count, bool)
        self.enter_step = np.full(count, -1)
        self.gate_m, self.cap_m_s = np.full(count, np.inf), np.full(count, np.inf)
        self.leave_x_m = np.full(count, np.inf)
        self.routes: list[list[int]] = [[] for _ in vehicles]
        self.shifts: list[list[Shift]] = [[] for _ in vehicles]
        self.legs: list[list[Leg]] = [[] for _ in vehicles]
        self.always_beside = -1
        """A second lane that vehicle 0 takes room on all the time, -1: none."""

    def enter(self, row: int, step: int, track: int, x_m: float, speed_m_s: float) -> None:
        """Vehicle `row` comes onto a track."""
        self.enter_step[row], self.active[row] = step, True
        self.speed_m_s[row] = speed_m_s
        self.go_on(row, track, x_m)

    def go_on(self, row: int, track: int, x_m: float) -> None:
        """Vehicle `row` is on another track from here on."""
        self.track[row], self.x_m[row] = track, x_m
        self.legs[row].append(Leg(track, x_m, float(self.gone_m[row])))

    def take_room(self, row: int, track: int, dx_m: float, until_gone_m: float) -> None:
        """Vehicle `row` is in the way on a second track, too."""
        self.beside[row], self.beside_dx_m[row], self.beside_ends_m[row] = track, dx_m, until_gone_m

    def leave(self, row: int) -> None:
        """Vehicle `row` goes for good."""
        self.active[row], self.left[row], self.beside[row] = False, True, -1

    def rows(self) -> Ints:
        """Vehicles that are there."""
        return np.flatnonzero(self.active)

    def on_track(self, track: int) -> tuple[Ints, Floats]:
        """Vehicles that take room on a track, and their x there."""
        rows = np.flatnonzero(self.active & ((self.track == track) | (self.beside == track)))
        beside = self.track[rows] != track
        return rows, self.x_m[rows] + np.where(beside, self.beside_dx_m[rows], 0.0)

    def on_loop(self) -> Ints:
        """Vehicles on the loop."""
        return np.flatnonzero(self.active & (self.track < LOOP_TRACKS))

    def locate(self) -> None:
        """Bring `around_m` up to date."""
        self.around_m = self.tracks.around(self.track, self.x_m)

    def order(self) -> Order:
        """Who follows whom."""
        rows = self.rows()
        changing = rows[self.beside[rows] >= 0]
        row = np.concatenate([rows, changing])
        track = np.concatenate([self.track[rows], self.beside[changing]])
        if self.always_beside >= 0:
            row, track = np.append(row, 0), np.append(track, self.always_beside)
        around = self.around_m[row]
        again = slice(len(rows), len(rows) + len(changing))
        around[again] = self.tracks.around(track[again], self.x_m[changing] + self.beside_dx_m[changing])
        sort = np.lexsort((around, track))
        row, track, around = row[sort], track[sort], around[sort]
        arc = self.tracks.arc_m(track, around)
        first = np.searchsorted(track, np.arange(len(self.tracks.length_m) + 1))
        ahead = np.arange(1, len(row) + 1)
        last = first[1:][first[1:] > first[:-1]] - 1
        ahead[last] = first[track[last]]
        away = arc[np.minimum(ahead, len(row) - 1)] - arc
        away[last] += self.tracks.round_arc_m[track[last]]
        for place in last[~self.tracks.closed[track[last]]].tolist():
            begin = self._first_beyond(int(row[place]), int(track[place]), first)
            ahead[place], away[place] = place, np.inf
            if begin >= 0:
                ahead[place] = begin
                away[place] = self.tracks.length_m[track[place]] - arc[place] + arc[begin]
        gap = away - 0.5 * (self.length_m[row] + self.length_m[row[ahead]])
        alone = np.isinf(gap) | (ahead == np.arange(len(row)))
        leader = np.where(alone, row, row[ahead])
        return Order(row, track, arc, np.where(alone, np.inf, gap), leader, first)

    def _first_beyond(self, row: int, track: int, first: Ints) -> int:
        """Place of who is first on the next track of a vehicle's route, whom it follows from the end of an open track;
        -1: nobody."""
        route = self.routes[row]
        if track != self.track[row] or not route or route[0] < LOOP_TRACKS:
            return -1
        begin, end = first[route[0]], first[route[0] + 1]
        return int(begin) if end > begin else -1
