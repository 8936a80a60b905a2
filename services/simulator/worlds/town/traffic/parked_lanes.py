# SPDX-License-Identifier: Apache-2.0
"""Lanes full of parked vehicles: the same wall of cars as in a jam, and none of them moves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.options import DriveOptions
from services.simulator.shapes.vehicles.styles import BICYCLE
from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.profile import CROSSING_CLEAR_M, LANE_CENTRES_M, ZEBRA_CLEAR_M
from services.simulator.worlds.town.traffic.fleet import draw_vehicle
from services.simulator.worlds.town.traffic.parking import Bay, Parked
from services.simulator.worlds.town.traffic.population import barred_track, shared_track
from services.simulator.worlds.town.traffic.tracks import LOOP_TRACKS

Floats = NDArray[np.float64]

_CAMERA_TRACK = 0
_GAP_M = (0.8, 2.5)
_TIGHT = 1.0 / 55.0
"""In bends from this curvature on nobody stands: straight vehicles reach into the next lane there."""
_DENSE = 1.0
"""Drawn as dense traffic is, with what is high in it."""


def vehicles_parked_on_lanes(options: DriveOptions, plan: TownPlan) -> list[Parked]:
    """Who stands on the lanes that the camera's car does not need; none at junctions and zebra crossings."""
    needed = {_CAMERA_TRACK, barred_track(options), shared_track(options)}
    tracks = [track for track in range(LOOP_TRACKS) if track not in needed]
    return [one for track in tracks for one in _on_lane(options, plan, track)] if options.parked_lanes else []


def _on_lane(options: DriveOptions, plan: TownPlan, track: int) -> list[Parked]:
    rng = np.random.default_rng([options.seed_of_traffic, 47, track])
    loop, lane, way = plan.loop, track % 2, track // 2
    n = (1.0 if way else -1.0) * LANE_CENTRES_M[lane]
    parked: list[Parked] = []
    end = 0.0
    while True:
        vehicle = draw_vehicle(rng, options.speed_m_s, _DENSE, lane)
        gap, taken = float(rng.uniform(*_GAP_M)), rng.random() < options.parked_lanes
        s = end + gap + 0.5 * vehicle.length_m
        end = s + 0.5 * vehicle.length_m
        if end > loop.length_m:
            return parked
        if taken and vehicle.style is not BICYCLE and _is_free(plan, s, vehicle.length_m):
            parked.append(Parked(vehicle, Bay(s, way, len(parked)), s, n, 0.0, starts=False))


def _is_free(plan: TownPlan, s: float, length_m: float) -> bool:
    loop = plan.loop
    ends: Floats = s + np.array([-0.5, 0.5]) * length_m
    if float(np.abs(np.diff(loop.heading(ends)))[0]) / length_m > _TIGHT:
        return False
    places = [(crossing.s_m, CROSSING_CLEAR_M) for crossing in plan.crossings]
    places += [(zebra, ZEBRA_CLEAR_M) for zebra in plan.zebras_m]
    half = 0.5 * loop.length_m
    return all(abs((s - place + half) % loop.length_m - half) >= clear + 0.5 * length_m for place, clear in places)
