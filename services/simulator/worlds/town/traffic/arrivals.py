# SPDX-License-Identifier: Apache-2.0
"""Who comes along the side streets, when, and where they want to go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from services.simulator.options import DriveOptions
from services.simulator.worlds.town.traffic.fleet import Vehicle, draw_vehicle
from services.simulator.worlds.town.traffic.network import Link, Network
from services.simulator.worlds.town.traffic.population import barred_track
from services.simulator.worlds.town.traffic.tracks import LOOP_TRACKS

_PER_S = 0.055
"""Arrivals on one street at full traffic."""
_SOON_S = 6.0
_MEETING = (0.25, 0.5)
"""Share of streets from which somebody comes just when the camera does: at least, and more with the traffic."""
_STRAIGHT_SHARE = 0.75


@dataclass(frozen=True, slots=True)
class Arrival:
    """A vehicle that comes at `time_s` at `x_m` of its first track; route: the tracks it takes after that one.

    meets_s_m: where on the loop it arrives with the camera's car, for which it comes when that is near enough; None:
    it comes by time alone.
    """

    vehicle: Vehicle
    time_s: float
    track: int
    x_m: float
    route: tuple[int, ...]
    meets_s_m: float | None = None


def side_arrivals(options: DriveOptions, network: Network, crossings_m: Sequence[float], end_s: float) -> list[Arrival]:
    """Those who meet the camera's car, then all others until `end_s`, by time. crossings_m: the junctions' s."""
    if options.traffic <= 0.0:
        return []
    meeting, found = [], []
    barred = barred_track(options)
    for number, arm in enumerate(network.arms):
        if arm.joined is not None:
            continue
        rng = np.random.default_rng([options.seed_of_traffic, 47, number])
        length_m = network.tracks[arm.track_in - LOOP_TRACKS].length_m
        first, way = draw_vehicle(rng, 8.0, options.traffic, 0), _route(rng, network, number, barred)
        if rng.random() < _MEETING[0] + _MEETING[1] * options.traffic:
            meeting.append(Arrival(first, 0.0, arm.track_in, 0.0, way, crossings_m[arm.crossing]))
        # One of them is on the way already.
        time_s = -float(rng.exponential(_SOON_S / options.traffic))
        while time_s < end_s:
            vehicle = draw_vehicle(rng, 8.0, options.traffic, 0)
            route = _route(rng, network, number, barred)
            x_m = float(rng.uniform(0.3, 0.9)) * length_m if time_s < 0.0 else 0.0
            if time_s > -_SOON_S:
                found.append(Arrival(vehicle, max(0.0, time_s), arm.track_in, x_m, route))
            time_s = max(time_s, 0.0) + 3.0 + float(rng.exponential(1.0 / (_PER_S * options.traffic)))
    return meeting + sorted(found, key=lambda arrival: arrival.time_s)


def _route(rng: np.random.Generator, network: Network, arm: int, barred: int) -> tuple[int, ...]:
    """Over the loop where that leads somewhere, through the blocks behind it, or onto it."""
    link = _choice(
        rng, [link for link in network.links if link.arm == arm and link.move != "off" and link.to != barred]
    )
    if link.move != "straight":
        return (link.track, link.to)
    there = next(number for number, other in enumerate(network.arms) if other.track_out == link.to)
    joined = network.arms[there].joined
    if joined is None:
        return (link.track, link.to)
    return (link.track, link.to, network.arms[joined].track_in, *_route(rng, network, joined, barred))


def _choice(rng: np.random.Generator, links: list[Link]) -> Link:
    straight = [link for link in links if link.move == "straight"]
    others = [link for link in links if link.move != "straight"]
    if straight and rng.random() < _STRAIGHT_SHARE:
        return straight[0]
    return others[int(rng.integers(0, len(others)))]
