# SPDX-License-Identifier: Apache-2.0
"""The traffic, step by step ahead of time. Nothing looks into the future: a longer run begins as a shorter one."""

from __future__ import annotations

from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.traffic.car_following import HARDEST_M_S2, following_acceleration
from services.simulator.worlds.town.traffic.lane_changes import LaneChanges
from services.simulator.worlds.town.traffic.state import Order, VehicleState

Floats = NDArray[np.float64]
Ints = NDArray[np.intp]

STEP_S = 0.1
_LINE_GAP_M = 0.6
"""Cars stop this far ahead of a stop line."""
_LINE_MARGIN_M, _FIRM_M_S2 = 0.1, 1.0
_STANDS_M_S = 0.3
_CORNER_BRAKE_M_S2 = 2.5


class Yielding(Protocol):
    """A place where the loop's traffic gives way, or somebody comes into it."""

    def step(self, state: VehicleState, rows: Ints, now_s: float, camera_free_s: float) -> None:
        """Look at the vehicles on the loop (`rows`) and act."""
        ...


class TrafficSimulation:
    """Vehicles on tracks; speeds change linearly over a step, so that positions follow exactly."""

    def __init__(self, state: VehicleState, places: list[Yielding], barred: int) -> None:
        self._state, self._places = state, places
        self._changes = LaneChanges(state, barred)
        self._speeds: list[tuple[Ints, Floats]] = []
        self._camera_free_s = -np.inf

    def run(self, steps: int) -> list[Floats]:
        """Speeds at every step from each vehicle's first one on, as many as there are."""
        state = self._state
        for number in range(steps + 1):
            now_s = number * STEP_S
            state.locate()
            state.gate_m[:], state.cap_m_s[:] = np.inf, np.inf
            rows = state.on_loop()
            for place in self._places:
                place.step(state, rows, now_s, self._camera_free_s)
            state.locate()
            rows = state.rows()
            self._speeds.append((rows, state.speed_m_s[rows].copy()))
            if state.speed_m_s[0] < _STANDS_M_S:
                self._camera_free_s = now_s
            self._advance(number)
        return self._by_vehicle()

    def _advance(self, number: int) -> None:
        state = self._state
        order = state.order()
        acceleration = self._behind_leaders(order)
        self._changes.step(number, order, acceleration)
        rows = state.rows()
        speed = state.speed_m_s[rows]
        gated = rows[np.isfinite(state.gate_m[rows])]
        if len(gated):
            gap = state.gate_m[gated] + state.drivers.standing_gap_m[gated] - _LINE_GAP_M
            stopping = self._following(gated, gap, np.zeros(len(gated)))
            # The model only creeps up to where it wants to stand; a stop line must hold.
            held = state.speed_m_s[gated]
            needed = held * held / (2.0 * np.maximum(state.gate_m[gated] - _LINE_MARGIN_M, _LINE_MARGIN_M))
            stopping = np.where(needed > _FIRM_M_S2, np.minimum(stopping, -needed), stopping)
            stopping = np.maximum(stopping, -HARDEST_M_S2)
            acceleration[gated] = np.minimum(acceleration[gated], stopping)
        later = np.maximum(speed + acceleration[rows] * STEP_S, 0.0)
        later = np.minimum(later, self._allowed(rows, speed))
        way = 0.5 * (speed + later) * STEP_S
        state.x_m[rows] += way
        state.gone_m[rows] += way
        state.speed_m_s[rows] = later

    def _allowed(self, rows: Ints, speed: Floats) -> Floats:
        """Corners are braked for as planned, however eager the driver."""
        state = self._state
        track = state.track[rows]
        ahead = state.tracks.around(track, state.x_m[rows] + speed * STEP_S)
        return np.asarray(np.maximum(state.tracks.limit_m_s(track, ahead), speed - _CORNER_BRAKE_M_S2 * STEP_S))

    def _behind_leaders(self, order: Order) -> Floats:
        """Acceleration in x of every vehicle (N,) behind all that it follows."""
        state = self._state
        each = self._following(order.row, order.gap_m, state.speed_m_s[order.leader])
        acceleration = np.full(len(state.x_m), np.inf)
        np.minimum.at(acceleration, order.row, each)
        return acceleration

    def _following(self, rows: Ints, gap_m: Floats, leader_m_s: Floats) -> Floats:
        state = self._state
        track, around = state.track[rows], state.around_m[rows]
        # Drivers feel metres of their own lane; x is the centre line's.
        stretch = state.tracks.stretch(track, around)
        wanted = np.minimum(state.wanted_m_s[rows], state.cap_m_s[rows])
        wanted = np.minimum(wanted, stretch * state.tracks.limit_m_s(track, around))
        speed = stretch * state.speed_m_s[rows]
        felt = following_acceleration(state.drivers.take(rows), speed, wanted, gap_m, stretch * leader_m_s)
        return felt / stretch

    def _by_vehicle(self) -> list[Floats]:
        rows = np.concatenate([rows for rows, _ in self._speeds])
        sort = np.argsort(rows, kind="stable")
        speeds = np.concatenate([speeds for _, speeds in self._speeds])[sort]
        ends = np.searchsorted(rows[sort], np.arange(len(self._state.x_m) + 1))
        return [speeds[a:b] for a, b in pairwise(ends)]
