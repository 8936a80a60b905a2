# SPDX-License-Identifier: Apache-2.0
"""Who comes along the side streets, when, and where they want to go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from services.simulator.options import DriveOptions
from services.simulator.worlds.town.traffic.fleet import Vehicle, draw_vehicle
from services.simulator.worlds.town.traffic.network import Link, Network

_PER_S = 0.055
"""Arrivals on one street at full traffic."""
_SOON_S = 6.0
_STRAIGHT_SHARE = 0.75


@dataclass(frozen=True, slots=True)
class Arrival:
    """A vehicle that comes at `time_s` at `x_m` of its first track; route: the tracks it takes after that one."""

    vehicle: Vehicle
    time_s: float
    track: int
    x_m: float
    route: tuple[int, ...]


def side_arrivals(options: DriveOptions, network: Network, end_s: float) -> list[Arrival]:
    """All until `end_s`, by time."""
    if options.traffic <= 0.0:
        return []
    found = []
    for number, arm in enumerate(network.arms):
        if arm.joined is not None:
            continue
        rng = np.random.default_rng([options.seed_of_traffic, 47, number])
        length_m = network.tracks[arm.track_in - 4].length_m
        # One of them is on the way already.
        time_s = -float(rng.exponential(_SOON_S / options.traffic))
        while time_s < end_s:
            vehicle = draw_vehicle(rng, 8.0, options.traffic, 0)
            route = _route(rng, network, number)
            x_m = float(rng.uniform(0.3, 0.9)) * length_m if time_s < 0.0 else 0.0
            if time_s > -_SOON_S:
                found.append(Arrival(vehicle, max(0.0, time_s), arm.track_in, x_m, route))
            time_s = max(time_s, 0.0) + 3.0 + float(rng.exponential(1.0 / (_PER_S * options.traffic)))
    return sorted(found, key=lambda arrival: arrival.time_s)


def _route(rng: np.random.Generator, network: Network, arm: int) -> tuple[int, ...]:
    """Over the loop where that leads somewhere, through the blocks behind it, or onto it."""
    link = _choice(rng, [link for link in network.links if link.arm == arm and link.move != "off"])
    if link.move != "straight":
        return (link.track, link.to)
    there = next(number for number, other in enumerate(network.arms) if other.track_out == link.to)
    joined = network.arms[there].joined
    if joined is None:
        return (link.track, link.to)
    return (link.track, link.to, network.arms[joined].track_in, *_route(rng, network, joined))


def _choice(rng: np.random.Generator, links: list[Link]) -> Link:
    straight = [link for link in links if link.move == "straight"]
    others = [link for link in links if link.move != "straight"]
    if straight and rng.random() < _STRAIGHT_SHARE:
        return straight[0]
    return others[int(rng.integers(0, len(others)))]
