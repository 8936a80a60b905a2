# SPDX-License-Identifier: Apache-2.0
"""What vehicles and people look like, drawn from the seeds of their looks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypedDict

import numpy as np

from services.simulator.shapes.meshes import Mesh, Tint
from services.simulator.shapes.people import Gait
from services.simulator.shapes.townspeople import draw_clothes, townsperson_mesh
from services.simulator.shapes.vehicles.cyclists import bicycle_mesh, rider_mesh
from services.simulator.shapes.vehicles.large_vehicles import (
    BOX_ADVERTS,
    BUS_LIVERIES,
    CARGOES,
    FIRMS,
    box_lorry_mesh,
    bus_mesh,
    delivery_mesh,
    flatbed_mesh,
)
from services.simulator.shapes.vehicles.styles import BICYCLE, BOX_LORRY, BUS, DELIVERY, FLATBED, LARGE, VehicleStyle
from services.simulator.shapes.vehicles.town_cars import PAINTS, town_car_mesh

_LIGHT = 0.35
"""Delivery vans are light, so that their names can be read."""


class Looks(TypedDict):
    """What an actor is, whatever its way."""

    category: str
    mesh: Mesh
    size_m: tuple[float, float, float]
    gait: Gait | None
    disc_radius_m: float
    disc_offsets_m: tuple[float, ...]
    half_base_m: float


class Wardrobe:
    """Makes looks; vehicles that look the same share their mesh."""

    def __init__(self, texture: Mapping[str, int]) -> None:
        self._texture = texture
        self._meshes: dict[tuple[str, int, int], Mesh] = {}

    def vehicle(self, style: VehicleStyle, look: int) -> Looks:
        """Of a vehicle; a bicycle comes without its rider."""
        rng = np.random.default_rng([look, 51])
        paint, variant = int(rng.integers(0, len(PAINTS))), int(rng.integers(0, 12))
        if style is BUS or (style is DELIVERY and min(PAINTS[paint]) < _LIGHT):
            paint = 0
        key = (style.name, paint, variant if style in LARGE else 0)
        if key not in self._meshes:
            self._meshes[key] = self._mesh(style, PAINTS[paint], variant)
        radius = 0.5 * style.size_m[1] + 0.1
        count = max(2, int(np.ceil(style.size_m[0] / (2.0 * radius))) + 1)
        half = 0.5 * style.size_m[0] - 0.7 * radius
        return Looks(
            category=style.category,
            mesh=self._meshes[key],
            size_m=style.size_m,
            gait=None,
            disc_radius_m=radius,
            disc_offsets_m=tuple(float(v) for v in np.linspace(-half, half, count)),
            half_base_m=style.half_base_m,
        )

    def _mesh(self, style: VehicleStyle, paint: Tint, variant: int) -> Mesh:
        if style is BUS:
            return bus_mesh(variant % BUS_LIVERIES, self._texture)
        if style is BOX_LORRY:
            return box_lorry_mesh(paint, variant % BOX_ADVERTS, self._texture)
        if style is FLATBED:
            return flatbed_mesh(paint, variant % CARGOES, self._texture)
        if style is DELIVERY:
            return delivery_mesh(paint, variant % FIRMS, self._texture)
        if style is BICYCLE:
            return bicycle_mesh(paint, self._texture)
        return town_car_mesh(style.name, paint, self._texture)

    def rider(self, look: int) -> Looks:
        """Of who rides a bicycle; upright on the bicycle's axles."""
        clothes = draw_clothes(np.random.default_rng([look, 53]), grown_up=True)
        return _person(*rider_mesh(clothes, self._texture), half_base_m=BICYCLE.half_base_m)

    def person(self, look: int) -> Looks:
        """Of somebody on foot."""
        clothes = draw_clothes(np.random.default_rng([look, 52]))
        return _person(*townsperson_mesh(clothes, self._texture), half_base_m=0.0)


def _person(mesh: Mesh, gait: Gait, size_m: tuple[float, float, float], half_base_m: float) -> Looks:
    return Looks(
        category="person",
        mesh=mesh,
        size_m=size_m,
        gait=gait,
        disc_radius_m=0.38,
        disc_offsets_m=(0.0,),
        half_base_m=half_base_m,
    )
