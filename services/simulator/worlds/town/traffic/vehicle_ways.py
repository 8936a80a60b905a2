# SPDX-License-Identifier: Apache-2.0
"""What the simulation decided, as paths through the world."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.motion import Path
from services.simulator.shapes.vehicles.styles import BICYCLE
from services.simulator.worlds.town.paths import ChainPath, LoopPath, PointsPath, Shift, Sway
from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import LANE_CENTRES_M
from services.simulator.worlds.town.traffic.fleet import LONG_M, Vehicle
from services.simulator.worlds.town.traffic.network import Network
from services.simulator.worlds.town.traffic.parking import PullOut
from services.simulator.worlds.town.traffic.state import Leg, VehicleState
from services.simulator.worlds.town.traffic.tracks import LOOP_TRACKS

Floats = NDArray[np.float64]

_CYCLIST_OUT_M = 0.78
"""Cyclists keep this far to the right of the outer lane's middle."""
_WIDE_M, _WIDER_M2, _BEND_M, _TIGHT = 0.6, 14.0, 10.0, 1.0 / 45.0
"""How far long vehicles keep out of bends at most, by how much for a curvature, felt over so
many metres; from which on: beside gentler ones there are bays."""
_SWAY_M, _SWAY_WAVE_M = 0.08, 23.0


class WayMaker:
    """Paths of vehicles from their legs and lane changes in a finished simulation."""

    def __init__(self, plan: TownPlan, network: Network, state: VehicleState, seed: int) -> None:
        self._plan, self._network, self._state, self._seed = plan, network, state, seed

    def path(self, row: int, vehicle: Vehicle) -> Path:
        """Of a vehicle that began on a track."""
        legs = self._state.legs[row]
        if len(legs) == 1 and legs[0].track < LOOP_TRACKS and not self._state.left[row]:
            if vehicle.style is BICYCLE:
                phase = float(np.random.default_rng([self._seed, 46, row]).uniform(0.0, 2.0 * np.pi))
                return self._on_loop(legs[0], [], _CYCLIST_OUT_M, Sway(_SWAY_M, _SWAY_WAVE_M, phase))
            if vehicle.length_m > LONG_M and legs[0].track % 2:
                return self._on_loop(legs[0], [], 0.0, None, self._wide_turns(legs[0].track))
            return self._on_loop(legs[0], self._state.shifts[row], 0.0, None)
        ends = [*(leg.gone_m for leg in legs[1:]), np.inf]
        paths = [self._leg(leg, end, self._state.shifts[row]) for leg, end in zip(legs, ends, strict=True)]
        return ChainPath(paths, [leg.gone_m for leg in legs], self._end_m(row))

    def out_of_bay(self, one: PullOut) -> Path:
        """Of a vehicle that pulls out of its bay, or is going to after the end."""
        parked, row = one.parked, one.row
        ahead = 1.0 if parked.bay.way == 0 else -1.0
        legs = self._state.legs[row]
        shifts = [Shift(0.0, one.merge_m, one.slide_m), *self._state.shifts[row]]
        first = LoopPath(self._plan, ahead, parked.s_m, parked.n_m, shifts=tuple(shifts))
        if len(legs) < 2:
            return first
        ends = [*(leg.gone_m for leg in legs[2:]), np.inf]
        others = [self._leg(leg, end, shifts) for leg, end in zip(legs[1:], ends, strict=True)]
        return ChainPath([first, *others], [leg.gone_m for leg in legs], self._end_m(row))

    def _leg(self, leg: Leg, end_gone_m: float, shifts: list[Shift]) -> Path:
        if leg.track >= LOOP_TRACKS:
            points, step_m = self._network.points[leg.track - LOOP_TRACKS]
            return PointsPath(points, step_m, self._plan.ground, from_m=leg.x_m)
        mine = [
            Shift(shift.begin_m - leg.gone_m, shift.length_m, shift.by_m)
            for shift in shifts
            if leg.gone_m <= shift.begin_m < end_gone_m
        ]
        return self._on_loop(leg, mine, 0.0, None)

    def _wide_turns(self, track: int) -> Floats:
        """Long vehicles on the outer lane keep to the right in tight bends, where their corners swing out."""
        loop = self._plan.loop
        s = np.linspace(0.0, loop.length_m, int(loop.length_m), endpoint=False)
        bend = np.abs(loop.heading(s + _BEND_M) - loop.heading(s - _BEND_M)) / (2.0 * _BEND_M)
        room: Floats = np.minimum(_WIDE_M, _WIDER_M2 * np.maximum(bend - _TIGHT, 0.0)) * (-1.0 if track < 2 else 1.0)
        return room

    def _on_loop(
        self, leg: Leg, shifts: list[Shift], out_m: float, sway: Sway | None, leeway: Floats | None = None
    ) -> LoopPath:
        ahead = 1.0 if leg.track < 2 else -1.0
        n = -ahead * (LANE_CENTRES_M[leg.track % 2] + out_m)
        return LoopPath(self._plan, ahead, ahead * leg.x_m, n, shifts=tuple(shifts), sway=sway, leeway=leeway)

    def _end_m(self, row: int) -> float:
        return float(self._state.gone_m[row]) if self._state.left[row] else np.inf
