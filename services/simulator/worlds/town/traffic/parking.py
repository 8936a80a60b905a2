# SPDX-License-Identifier: Apache-2.0
"""Parking bays: which there are, who stands in them, and who pulls out when the camera comes near."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.options import DriveOptions
from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import (
    BAY_CENTRE_M,
    BAY_LENGTH_M,
    CROSSING_CLEAR_M,
    LANE_CENTRES_M,
    ZEBRA_CLEAR_M,
)
from services.simulator.worlds.town.traffic.fleet import Vehicle, draw_parked
from services.simulator.worlds.town.traffic.state import VehicleState

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

PARKED_N_M = BAY_CENTRE_M + 0.05
_STRAIGHT = 1.0 / 55.0
_CROOKED = 1.0 / 3.0
_CROOKED_RAD = (0.02, 0.075)
_MERGE_M = 9.5
_TRIGGER_M = (16.0, 40.0)
_FREE_AHEAD_M, _FREE_BEHIND_M = 14.0, 9.0
_FREE_BEHIND_S = 3.5
_LONGEST_STARTER_M = 5.0


@dataclass(frozen=True, slots=True)
class Bay:
    """A bay by the middle `s_m`, on the loop's right (way 0) or left (way 1); number: its own among all."""

    s_m: float
    way: int
    number: int


@dataclass(frozen=True, slots=True)
class Parked:
    """A vehicle in a bay: its middle `s_m`, offset `n_m` and how far it stands crooked; starts: it pulls out."""

    vehicle: Vehicle
    bay: Bay
    s_m: float
    n_m: float
    crooked_rad: float
    starts: bool


def parking_bays(plan: TownPlan) -> list[Bay]:
    """All bays: none at junctions and zebra crossings, none in tight bends."""
    length = plan.loop.length_m
    count = int(length / BAY_LENGTH_M)
    s: Floats = (np.arange(count, dtype=np.float64) + 0.5) * BAY_LENGTH_M
    half = 0.5 * BAY_LENGTH_M
    bend = np.abs(plan.loop.heading(s + 2.0 * half) - plan.loop.heading(s - 2.0 * half)) / (4.0 * half)
    kept = bend < _STRAIGHT
    for place, clear in [(c.s_m, CROSSING_CLEAR_M) for c in plan.crossings] + [
        (zebra, ZEBRA_CLEAR_M) for zebra in plan.zebras_m
    ]:
        kept &= np.abs((s - place + 0.5 * length) % length - 0.5 * length) >= clear + half
    return [Bay(float(s[k]), way, way * count + int(k)) for way in (0, 1) for k in np.flatnonzero(kept)]


def parked_vehicles(options: DriveOptions, bays: list[Bay]) -> list[Parked]:
    """Who stands in the bays at the start. Who is to pull out has the next bay ahead free."""
    taken = {}
    for bay in bays:
        rng = np.random.default_rng([options.seed_of_traffic, 42, bay.number])
        if rng.random() < options.parked:
            taken[bay.number] = (bay, rng)
    parked = []
    for number, (bay, rng) in taken.items():
        vehicle = draw_parked(rng, options.speed_m_s, options.traffic)
        ahead = number + (1 if bay.way == 0 else -1)
        wants = rng.random() < 0.3 + 0.3 * options.traffic and options.traffic > 0.0
        starts = bool(wants and ahead not in taken and vehicle.length_m < _LONGEST_STARTER_M)
        crooked = float(rng.uniform(*_CROOKED_RAD) * rng.choice([-1.0, 1.0])) if rng.random() < _CROOKED else 0.0
        room = 0.5 * (BAY_LENGTH_M - vehicle.length_m) - 0.2
        s = bay.s_m + float(rng.uniform(-room, room))
        n = (1.0 if bay.way else -1.0) * (PARKED_N_M + float(rng.uniform(-0.08, 0.08)))
        parked.append(Parked(vehicle, bay, s, n, 0.0 if starts else crooked, starts))
    return parked


class PullOut:
    """A parked car that goes onto the outer lane when the camera comes near and the lane is free."""

    def __init__(self, parked: Parked, row: int) -> None:
        self.parked, self.row = parked, row
        self._track = 2 * parked.bay.way + 1
        self._x_m = parked.s_m if parked.bay.way == 0 else -parked.s_m
        rng = np.random.default_rng([parked.vehicle.look, 43])
        self._trigger_m = float(rng.uniform(*_TRIGGER_M)) * (1.0 if parked.bay.way == 0 else 1.3)
        self._wants = self._gone = False

    @property
    def merge_m(self) -> float:
        """Way on which it slides over to the lane."""
        return _MERGE_M

    @property
    def slide_m(self) -> float:
        """By how much, left of the loop positive."""
        side = 1.0 if self.parked.bay.way else -1.0
        return side * LANE_CENTRES_M[1] - self.parked.n_m

    def step(self, state: VehicleState, rows: Ints, now_s: float, camera_free_s: float) -> None:
        """Pull out when it is time."""
        if self._gone:
            return
        length = state.tracks.length_m[0]
        ahead = (self.parked.s_m - state.x_m[0]) % length
        self._wants = self._wants or 6.0 < ahead < self._trigger_m
        if not self._wants:
            return
        lane, x_m = state.on_track(self._track)
        offset = (x_m - self._x_m + 0.5 * length) % length - 0.5 * length
        reach = 0.5 * (state.length_m[lane] + self.parked.vehicle.length_m)
        before = (offset > -reach) & (offset < reach + _FREE_AHEAD_M)
        follows = (offset <= 0.0) & (-offset < reach + _FREE_BEHIND_M + _FREE_BEHIND_S * state.speed_m_s[lane])
        if not (before | follows).any():
            state.enter(self.row, round(now_s * 10.0), self._track, self._x_m, 0.0)
            self._gone = True
