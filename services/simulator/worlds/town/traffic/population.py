# SPDX-License-Identifier: Apache-2.0
"""Who is on the loop when the drive begins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.options import DriveOptions
from services.simulator.shapes.vehicles.styles import BUS
from services.simulator.worlds.town.traffic.fleet import Vehicle, camera_car, draw_vehicle
from services.simulator.worlds.town.traffic.tracks import LOOP_TRACKS, Tracks

Floats = NDArray[np.float64]

CAMERA_AHEAD_M = 1.1
"""The camera is this far ahead of the middle of its car."""
_LEAST_GAP_M = 3.5
_DENSE_M_S = 4.5
_NEAR_LEADER = 0.15
"""From this traffic on somebody is ahead of the camera from the start."""
_ONCOMING_INNER, _OWN_OUTER = 2, 1
_WIDE_M = 0.5
"""Driving this far beside its lane's middle, the camera's car takes room on the next one."""


@dataclass(frozen=True, slots=True)
class Placed:
    """A vehicle at the start of the drive."""

    vehicle: Vehicle
    track: int
    x_m: float
    speed_m_s: float


def barred_track(options: DriveOptions) -> int:
    """The lane that the camera's car, driving far to the left, leaves no room on, -1: none."""
    return _ONCOMING_INNER if options.lateral_offset_m > _WIDE_M else -1


def shared_track(options: DriveOptions) -> int:
    """The second lane that the camera's car takes room on, -1: none."""
    return _OWN_OUTER if options.lateral_offset_m < -_WIDE_M else -1


def loop_population(options: DriveOptions, tracks: Tracks) -> list[Placed]:
    """Everybody on the loop at time 0; the camera's car is the first."""
    start = options.start_m - CAMERA_AHEAD_M
    speed = min(
        options.speed_m_s, float(tracks.limit_m_s(np.zeros(1, np.intp), np.array([start % tracks.length_m[0]]))[0])
    )
    placed = [Placed(camera_car(options.speed_m_s, options.traffic), 0, start, speed)]
    for track in range(LOOP_TRACKS):
        if track != barred_track(options):
            placed += _lane(options, tracks, track, start)
    return placed


def fill_of(traffic: float) -> float:
    """Share of the road's room that is taken."""
    return float(0.8 * traffic**1.15)


def _lane(options: DriveOptions, tracks: Tracks, track: int, start_m: float) -> list[Placed]:
    """Vehicles of one lane, one after the other with gaps drawn at random; the camera's car closes the first one."""
    traffic = options.traffic
    rng = np.random.default_rng([options.seed_of_traffic, 41, track])
    length, room_m = float(tracks.length_m[track]), float(tracks.round_arc_m[track])
    vehicles: list[Vehicle] = []
    own = track == 0 or track == shared_track(options)
    used = 12.0 if own else 0.0
    while traffic > 0.0:
        first = track == 0 and not vehicles and rng.random() < traffic**2
        vehicle = draw_vehicle(rng, options.speed_m_s, traffic, track % 2, BUS if first else None)
        used += vehicle.length_m + _LEAST_GAP_M + (1.15 - 0.45 * traffic) * _DENSE_M_S
        if used > fill_of(traffic) * room_m:
            break
        vehicles.append(vehicle)
    if not vehicles:
        return []
    weight = rng.uniform(0.4, 1.6, len(vehicles) + 1)
    if track == 0 and traffic >= _NEAR_LEADER:
        weight[0] *= 0.25
    taken = sum(vehicle.length_m for vehicle in vehicles) + (vehicles[0].length_m if not own else 6.0)
    free = room_m - taken - _LEAST_GAP_M * len(weight)
    gaps = _LEAST_GAP_M + free * weight / weight.sum()
    scale = length / room_m
    x = start_m + 3.0 if own else float(rng.uniform(0.0, length))
    placed = []
    for k, vehicle in enumerate(vehicles):
        x += scale * (gaps[k] + 0.5 * vehicle.length_m)
        reach = max(0.0, gaps[k + 1] - vehicle.standing_gap_m) / vehicle.time_gap_s
        around = tracks.around(np.array([track]), np.array([x]))
        limit = float(tracks.limit_m_s(np.array([track]), around)[0])
        placed.append(Placed(vehicle, track, x, min(vehicle.wanted_m_s, limit, reach)))
        x += scale * 0.5 * vehicle.length_m
    return placed
