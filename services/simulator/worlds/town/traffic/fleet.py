# SPDX-License-Identifier: Apache-2.0
"""Who is on the roads: what kinds of vehicles there are and how their drivers drive."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.vehicles.styles import BICYCLE, KINDS, VehicleStyle
from services.simulator.worlds.town.traffic.car_following import Drivers

Floats = NDArray[np.float64]

EGO_LENGTH_M, EGO_WIDTH_M = 4.4, 1.8
LONG_M = 7.0
"""Vehicles longer than this keep to one lane."""
_HIGH_M = 1.7
_BASE_M_S = (6.0, 14.0)


@dataclass(frozen=True, slots=True)
class Vehicle:
    """One vehicle and its driver. style: None for the camera's car. look: seed of its paint and rider.

    wanted_m_s: speed on an empty road. The rest is what `car_following.Drivers` holds in columns.
    """

    style: VehicleStyle | None
    look: int
    length_m: float
    width_m: float
    wanted_m_s: float
    accelerate_m_s2: float
    brake_m_s2: float
    time_gap_s: float
    standing_gap_m: float

    @property
    def keeps_lane(self) -> bool:
        """Whether it never overtakes."""
        return self.style is None or self.style is BICYCLE or self.length_m > LONG_M


def camera_car(speed_m_s: float, traffic: float) -> Vehicle:
    """The car that the camera is in."""
    return Vehicle(None, 0, EGO_LENGTH_M, EGO_WIDTH_M, speed_m_s, 1.6, 2.0, 1.2 - 0.5 * traffic, 2.4)


def draw_vehicle(
    rng: np.random.Generator, base_m_s: float, traffic: float, lane: int, style: VehicleStyle | None = None
) -> Vehicle:
    """A vehicle with its driver for a lane (0 inner, 1 outer); base_m_s: what is usual here."""
    base = float(np.clip(base_m_s, *_BASE_M_S))
    if style is None:
        kinds = [kind for kind in KINDS if lane == 1 or kind.in_every_lane]
        # Dense traffic hides more of the street: more of it is high.
        high = np.array([kind.in_every_lane and kind.size_m[2] > _HIGH_M for kind in kinds])
        weight = np.array([kind.share for kind in kinds]) * (1.0 + 1.5 * traffic * high)
        style = kinds[int(rng.choice(len(kinds), p=weight / weight.sum()))]
    factor = float(rng.uniform(0.94, 1.22) if lane == 0 else rng.uniform(0.74, 1.12))
    wanted = base * factor * (0.88 if style.size_m[0] > LONG_M else 1.0)
    if style is BICYCLE:
        wanted = float(rng.uniform(3.8, 5.6))
    slow = style is BICYCLE or style.size_m[0] > LONG_M
    return Vehicle(
        style,
        int(rng.integers(0, 2**31)),
        style.size_m[0],
        style.size_m[1],
        wanted,
        float(rng.uniform(0.9, 1.2) if slow else rng.uniform(1.3, 2.0)),
        2.0,
        float(rng.uniform(1.0, 1.5)) - 0.45 * traffic,
        float(rng.uniform(1.6, 2.4)),
    )


def draw_parked(rng: np.random.Generator, base_m_s: float, traffic: float) -> Vehicle:
    """A vehicle that fits into a bay."""
    kinds = [kind for kind in KINDS if kind.parks]
    weight = np.array([kind.share for kind in kinds])
    style = kinds[int(rng.choice(len(kinds), p=weight / weight.sum()))]
    return draw_vehicle(rng, base_m_s, traffic, 1, style)


def drivers_of(vehicles: list[Vehicle]) -> Drivers:
    """Their wishes as columns."""
    rows = [(v.accelerate_m_s2, v.brake_m_s2, v.time_gap_s, v.standing_gap_m) for v in vehicles]
    return Drivers(*np.array(rows, np.float64).reshape(-1, 4).T)
