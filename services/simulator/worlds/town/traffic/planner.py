# SPDX-License-Identifier: Apache-2.0
"""Everybody in the town, as actors, and the way of the camera's car among them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.actor import Actor
from services.simulator.actors.motion import Path, SpeedProfile
from services.simulator.options import DriveOptions
from services.simulator.shapes.vehicles.styles import BICYCLE
from services.simulator.worlds.town.paths import LoopPath, StraightPath, Sway
from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import LANE_CENTRES_M
from services.simulator.worlds.town.traffic.arrivals import side_arrivals
from services.simulator.worlds.town.traffic.camera_car import CarCamera
from services.simulator.worlds.town.traffic.crossers import draw_crossers
from services.simulator.worlds.town.traffic.fleet import Vehicle
from services.simulator.worlds.town.traffic.junctions import Junction
from services.simulator.worlds.town.traffic.looks import Wardrobe
from services.simulator.worlds.town.traffic.network import Network
from services.simulator.worlds.town.traffic.parked_lanes import vehicles_parked_on_lanes
from services.simulator.worlds.town.traffic.parking import Parked, PullOut, parked_vehicles, parking_bays
from services.simulator.worlds.town.traffic.pavements import pedestrians
from services.simulator.worlds.town.traffic.population import barred_track, loop_population, shared_track
from services.simulator.worlds.town.traffic.side_traffic import SideTraffic
from services.simulator.worlds.town.traffic.simulation import STEP_S, TrafficSimulation, Yielding
from services.simulator.worlds.town.traffic.state import VehicleState
from services.simulator.worlds.town.traffic.tracks import Tracks, loop_tracks
from services.simulator.worlds.town.traffic.vehicle_ways import WayMaker
from services.simulator.worlds.town.traffic.zebras import Zebra

Floats = NDArray[np.float64]

_SPARE_S = 2.0
"""Simulated beyond the last frame."""
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
        self._network = Network(plan)
        self._placed = loop_population(options, Tracks(loop_tracks(plan)))
        self._parked = parked_vehicles(options, parking_bays(plan)) + vehicles_parked_on_lanes(options, plan)
        starters = [one for one in self._parked if one.starts]
        self._pull_outs = [PullOut(one, len(self._placed) + k) for k, one in enumerate(starters)]
        self._arrivals = side_arrivals(
            options, self._network, [crossing.s_m for crossing in plan.crossings], self._end_s
        )
        rng = np.random.default_rng([options.seed_of_traffic, 45])
        self._crossers = draw_crossers(rng, len(plan.zebras_m), options.traffic)

    def plan(self) -> tuple[list[Actor], CarCamera]:
        options = self._options
        state, speeds = self._simulated()
        camera = self._camera(state, speeds[0])
        ways = WayMaker(self._plan, self._network, state, options.seed_of_traffic)
        for row, placed in enumerate(self._placed[1:], 1):
            self._add_vehicle(placed.vehicle, ways.path(row, placed.vehicle), speeds[row], 0.0)
        for one in self._pull_outs:
            begin_s = float(state.enter_step[one.row]) * STEP_S
            # Who has not pulled out yet does so after the end, so that a longer drive begins with the same actors.
            waits = begin_s < 0.0
            drawn = np.array([0.0, 1.0]) if waits else speeds[one.row]
            self._add_vehicle(one.parked.vehicle, ways.out_of_bay(one), drawn, self._end_s if waits else begin_s)
        for parked in self._parked:
            if not parked.starts:
                self._add_vehicle(parked.vehicle, self._bay_path(parked), np.zeros(2), 0.0)
        for crosser in self._crossers:
            self._add_person(crosser.path(self._plan), crosser.speed(self._end_s), crosser.look)
        for person in pedestrians(self._plan, options):
            self._add_person(person.path, person.speed, person.look)
        # Who has not come by the end keeps his number, so that a longer drive begins with the same ones.
        first_id = len(self._actors) + 1
        for number, arrival in enumerate(self._arrivals):
            row = len(self._placed) + len(self._pull_outs) + number
            if state.enter_step[row] >= 0:
                begin_s = float(state.enter_step[row]) * STEP_S
                path = ways.path(row, arrival.vehicle)
                self._add_vehicle(arrival.vehicle, path, speeds[row], begin_s, first_id + number)
        return self._actors, camera

    def _simulated(self) -> tuple[VehicleState, list[Floats]]:
        options, plan = self._options, self._plan
        vehicles = [one.vehicle for one in self._placed]
        vehicles += [one.parked.vehicle for one in self._pull_outs] + [one.vehicle for one in self._arrivals]
        state = VehicleState(vehicles, Tracks([*loop_tracks(plan), *self._network.tracks]))
        state.always_beside = shared_track(options)
        for row, one in enumerate(self._placed):
            state.enter(row, 0, one.track, one.x_m, one.speed_m_s)
        count, round_m = len(vehicles), plan.loop.length_m
        seed, traffic = options.seed_of_traffic, options.traffic
        zebras = [
            Zebra(plan, k, self._crossers, vehicles=count, traffic=traffic, seed=seed)
            for k in range(len(plan.zebras_m))
        ]
        junctions = [
            Junction(plan, self._network, k, vehicles=count, traffic=traffic, seed=seed)
            for k in range(len(plan.crossings))
        ]
        for zebra in zebras:
            zebra.site.know([junction.site for junction in junctions], round_m)
        for junction in junctions:
            junction.site.know([zebra.site for zebra in zebras], round_m)
        first = len(self._placed) + len(self._pull_outs)
        side = SideTraffic(self._network, self._arrivals, first, STEP_S)
        places: list[Yielding] = [side, *zebras, *junctions, *self._pull_outs]
        steps = int(np.ceil(self._end_s / STEP_S))
        return state, TrafficSimulation(state, places, barred_track(options)).run(steps)

    def _add_vehicle(
        self, vehicle: Vehicle, path: Path, speeds: Floats, begin_s: float, number: int | None = None
    ) -> None:
        assert vehicle.style is not None
        times = begin_s + STEP_S * np.arange(len(speeds))
        profile = SpeedProfile(list(zip(times.tolist(), speeds.tolist(), strict=True)))
        looks = [self._wardrobe.vehicle(vehicle.style, vehicle.look)]
        if vehicle.style is BICYCLE:
            looks.append(self._wardrobe.rider(vehicle.look))
        for look in looks:
            self._actors.append(Actor(number or len(self._actors) + 1, path=path, speed=profile, **look))

    def _add_person(self, path: Path, speed: SpeedProfile, look: int) -> None:
        self._actors.append(Actor(len(self._actors) + 1, path=path, speed=speed, **self._wardrobe.person(look)))

    def _bay_path(self, parked: Parked) -> StraightPath:
        loop = self._plan.loop
        heading = float(loop.heading(parked.s_m)) + parked.crooked_rad + (np.pi if parked.bay.way else 0.0)
        return StraightPath(loop.point(parked.s_m, parked.n_m), heading, self._plan.ground)

    def _camera(self, state: VehicleState, speeds: Floats) -> CarCamera:
        n = self._options.lateral_offset_m - LANE_CENTRES_M[0]
        path = LoopPath(self._plan, 1.0, state.legs[0][0].x_m, n, sway=_CAMERA_SWAY)
        times = STEP_S * np.arange(len(speeds))
        profile = SpeedProfile(list(zip(times.tolist(), speeds.tolist(), strict=True)))
        return CarCamera(path, profile, self._options.camera_height_m)
