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


class VehicleState:
    """Columns over all vehicles (N,), those included who have not come yet or are gone.

    x_m: middle of the vehicle on its track. beside: a second track it takes room on, -1: none. enter_x_m, enter_step:
    where and when it came. gate_m: road to a stop line that holds it.
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
        self.x_m, self.speed_m_s = np.zeros(count), np.zeros(count)
        self.around_m = np.zeros(count)
        self.active = np.zeros(count, bool)
        self.enter_x_m, self.enter_step = np.zeros(count), np.full(count, -1)
        self.gate_m = np.full(count, np.inf)
        self.shifts: list[list[Shift]] = [[] for _ in vehicles]
        self.shift_ends_m = np.full(count, -np.inf)
        self.always_beside = -1
        """A second lane that vehicle 0 takes room on all the time, -1: none."""

    def enter(self, row: int, step: int, track: int, x_m: float, speed_m_s: float) -> None:
        """Vehicle `row` comes onto a track."""
        self.track[row], self.x_m[row], self.speed_m_s[row] = track, x_m, speed_m_s
        self.enter_x_m[row], self.enter_step[row] = x_m, step
        self.active[row] = True

    def rows(self) -> Ints:
        """Vehicles that are there."""
        return np.flatnonzero(self.active)

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
        sort = np.lexsort((around, track))
        row, track, around = row[sort], track[sort], around[sort]
        arc = self.tracks.arc_m(track, around)
        first = np.searchsorted(track, np.arange(len(self.tracks.length_m) + 1))
        ahead = np.arange(1, len(row) + 1)
        last = first[1:][first[1:] > first[:-1]] - 1
        ahead[last] = first[track[last]]
        closed = self.tracks.closed[track]
        away = arc[ahead] - arc
        away[last] += np.where(closed[last], self.tracks.round_arc_m[track[last]], np.inf)
        gap = away - 0.5 * (self.length_m[row] + self.length_m[row[ahead]])
        alone = np.isinf(gap) | (ahead == np.arange(len(row)))
        leader = np.where(alone, row, row[ahead])
        return Order(row, track, arc, np.where(alone, np.inf, gap), leader, first)
