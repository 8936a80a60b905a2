# SPDX-License-Identifier: Apache-2.0
"""Everybody in the town, as actors, and the way of the camera's car among them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.actor import Actor
from services.simulator.actors.motion import Path, SpeedProfile
from services.simulator.options import DriveOptions
from services.simulator.shapes.vehicle_styles import BICYCLE, VehicleStyle
from services.simulator.worlds.town.paths import LoopPath, Shift, StraightPath, Sway
from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import LANE_CENTRES_M
from services.simulator.worlds.town.traffic.camera_car import CarCamera
from services.simulator.worlds.town.traffic.crossers import draw_crossers
from services.simulator.worlds.town.traffic.fleet import LONG_M, Vehicle
from services.simulator.worlds.town.traffic.looks import Wardrobe
from services.simulator.worlds.town.traffic.parking import Parked, PullOut, parked_vehicles, parking_bays
from services.simulator.worlds.town.traffic.pavements import pedestrians
from services.simulator.worlds.town.traffic.population import barred_track, loop_population, shared_track
from services.simulator.worlds.town.traffic.simulation import STEP_S, TrafficSimulation
from services.simulator.worlds.town.traffic.state import VehicleState
from services.simulator.worlds.town.traffic.tracks import Tracks, loop_tracks
from services.simulator.worlds.town.traffic.zebras import Zebra

Floats = NDArray[np.float64]

_SPARE_S = 2.0
"""Simulated beyond the last frame."""
_CYCLIST_OUT_M = 0.78
"""Cyclists keep this far to the right of the outer lane's middle."""
_CAMERA_SWAY = Sway(0.12, 125.0, 0.0)


def plan_traffic(options: DriveOptions, plan: TownPlan, texture: Mapping[str, int]) -> tuple[list[Actor], CarCamera]:
    """Actors, ids from 1, and the camera's way. `options.traffic_seed` draws all of it.

    A drive of more frames begins as the shorter one does, ids included. texture: name to number in the atlas.
    """
    return _Planner(options, plan, texture).plan()


class _Planner:
    def __init__(self, options: DriveOptions, plan: TownPlan, texture: Mapping[str, int]) -> None:
        self._options, self._plan = options, plan
        self._wardrobe = Wardrobe(texture)
        self._end_s = options.timestamp_ns(options.frames) * 1e-9 + _SPARE_S
        self._actors: list[Actor] = []

    def plan(self) -> tuple[list[Actor], CarCamera]:
        options, plan = self._options, self._plan
        tracks = Tracks(loop_tracks(plan))
        placed = loop_population(options, tracks)
        parked = parked_vehicles(options, parking_bays(plan))
        starters = [one for one in parked if one.starts]
        vehicles = [one.vehicle for one in placed] + [one.vehicle for one in starters]
        state = VehicleState(vehicles, tracks)
        state.always_beside = shared_track(options)
        for row, one in enumerate(placed):
            state.enter(row, 0, one.track, one.x_m, one.speed_m_s)
        pull_outs = [PullOut(one, len(placed) + k) for k, one in enumerate(starters)]
        rng = np.random.default_rng([options.seed_of_traffic, 45])
        crossers = draw_crossers(rng, len(plan.zebras_m), options.traffic)
        zebras = [Zebra(plan, number, crossers, len(vehicles), options.traffic) for number in range(len(plan.zebras_m))]
        speeds = TrafficSimulation(state, [*zebras, *pull_outs], barred_track(options)).run(
            int(np.ceil(self._end_s / STEP_S))
        )
        for row, one in enumerate(placed[1:], 1):
            self._drive(one.vehicle, *self._on_loop(state, row, one.track, one.vehicle.style), speeds[row])
        for starter in pull_outs:
            self._pull_out(starter, state, speeds[starter.row])
        for stander in parked:
            if not stander.starts:
                self._stand(stander)
        for crosser in crossers:
            look = int(rng.integers(0, 2**31))
            self._add_person(crosser.path(plan), crosser.speed(), look)
        for person in pedestrians(plan, options):
            self._add_person(person.path, person.speed, person.look)
        return self._actors, self._camera(state, speeds[0])

    def _on_loop(self, state: VehicleState, row: int, track: int, style: VehicleStyle | None) -> tuple[Path, float]:
        """Path of a vehicle that is on the loop from the start, and when that is."""
        outside = -1.0 if track < 2 else 1.0
        length_m = float(state.length_m[row])
        out_m = _CYCLIST_OUT_M if style is BICYCLE else 0.0
        n = outside * (LANE_CENTRES_M[track % 2] + out_m)
        ahead = 1.0 if track < 2 else -1.0
        return self._loop_path(
            ahead, ahead * float(state.enter_x_m[row]), n, shifts=state.shifts[row], length_m=length_m, row=row
        ), 0.0

    def _loop_path(
        self, ahead: float, s_m: float, n_m: float, *, shifts: list[Shift], length_m: float, row: int
    ) -> LoopPath:
        phase = float(np.random.default_rng([self._options.seed_of_traffic, 46, row]).uniform(0.0, 6.28))
        sway = Sway(0.0 if length_m > LONG_M else 0.08, 90.0, phase)
        return LoopPath(self._plan, ahead, s_m, n_m, shifts=tuple(shifts), sway=sway)

    def _drive(self, vehicle: Vehicle, path: Path, begin_s: float, speeds: Floats) -> None:
        assert vehicle.style is not None
        profile = _profile(speeds, begin_s)
        looks = self._wardrobe.vehicle(vehicle.style, vehicle.look)
        self._actors.append(Actor(len(self._actors) + 1, path=path, speed=profile, **looks))
        if vehicle.style is BICYCLE:
            rider = self._wardrobe.rider(vehicle.look)
            self._actors.append(Actor(len(self._actors) + 1, path=path, speed=profile, **rider))

    def _pull_out(self, one: PullOut, state: VehicleState, speeds: Floats) -> None:
        parked = one.parked
        ahead = 1.0 if parked.bay.way == 0 else -1.0
        shifts = [Shift(0.0, one.merge_m, one.slide_m), *state.shifts[one.row]]
        path = LoopPath(self._plan, ahead, parked.s_m, parked.n_m, shifts=tuple(shifts))
        begin = int(state.enter_step[one.row])
        if begin < 0:
            self._drive(parked.vehicle, path, self._end_s, np.array([0.0, 1.0]))
        else:
            self._drive(parked.vehicle, path, begin * STEP_S, speeds)

    def _stand(self, parked: Parked) -> None:
        loop = self._plan.loop
        heading = float(loop.heading(parked.s_m)) + parked.crooked_rad + (np.pi if parked.bay.way else 0.0)
        path = StraightPath(loop.point(parked.s_m, parked.n_m), heading, self._plan.ground)
        self._drive(parked.vehicle, path, 0.0, np.zeros(2))

    def _add_person(self, path: Path, speed: SpeedProfile, look: int) -> None:
        self._actors.append(Actor(len(self._actors) + 1, path=path, speed=speed, **self._wardrobe.person(look)))

    def _camera(self, state: VehicleState, speeds: Floats) -> CarCamera:
        n = self._options.lateral_offset_m - LANE_CENTRES_M[0]
        path = LoopPath(self._plan, 1.0, float(state.enter_x_m[0]), n, sway=_CAMERA_SWAY)
        return CarCamera(path, _profile(speeds, 0.0), self._options.camera_height_m)


def _profile(speeds: Floats, begin_s: float) -> SpeedProfile:
    """Speed over time from speeds step by step; before the first one it stands if that is zero."""
    times = begin_s + STEP_S * np.arange(len(speeds))
    return SpeedProfile(list(zip(times.tolist(), speeds.tolist(), strict=True)))
