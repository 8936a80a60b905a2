# SPDX-License-Identifier: Apache-2.0
"""What vehicles and people look like, drawn from the seeds of their looks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypedDict

import numpy as np

from services.simulator.shapes import people, vehicles
from services.simulator.shapes.meshes import Mesh, Tint
from services.simulator.shapes.vehicle_styles import VehicleStyle

_LARGE_M = 2.4


class Looks(TypedDict):
    """What an actor is, whatever its way."""

    category: str
    mesh: Mesh
    size_m: tuple[float, float, float]
    gait: people.Gait | None
    disc_radius_m: float
    disc_offsets_m: tuple[float, ...]
    half_base_m: float


class Wardrobe:
    """Makes looks; equal ones share their mesh."""

    def __init__(self, texture: Mapping[str, int]) -> None:
        self._texture = texture
        self._meshes: dict[tuple[str, Tint], Mesh] = {}

    def vehicle(self, style: VehicleStyle, look: int) -> Looks:
        """Of a vehicle; a bicycle comes without its rider."""
        rng = np.random.default_rng([look, 51])
        paint = vehicles.PAINTS[int(rng.integers(0, len(vehicles.PAINTS)))]
        if (style.name, paint) not in self._meshes:
            body = vehicles.STYLES[2 if style.size_m[2] > 2.0 else int(rng.integers(0, 2))]
            scale = np.diag([*(a / b for a, b in zip(style.size_m, body.size_m, strict=True)), 1.0])
            self._meshes[style.name, paint] = vehicles.car_mesh(body, paint, self._texture).transformed(scale)
        radius = 0.5 * style.size_m[1] + 0.1
        count = max(2, int(np.ceil(style.size_m[0] / (2.0 * radius))) + 1)
        half = 0.5 * style.size_m[0] - 0.7 * radius
        return Looks(
            category=style.category,
            mesh=self._meshes[style.name, paint],
            size_m=style.size_m,
            gait=None,
            disc_radius_m=radius,
            disc_offsets_m=tuple(float(v) for v in np.linspace(-half, half, count)),
            half_base_m=style.half_base_m,
        )

    def person(self, look: int) -> Looks:
        """Of somebody on foot."""
        rng = np.random.default_rng([look, 52])
        height = float(rng.uniform(1.58, 1.88))
        jacket = int(rng.integers(0, people.JACKET_COUNT))
        mesh, gait = people.person_mesh(jacket, height, self._texture, bool(rng.random() < 0.5))
        size = (people.PERSON_SIZE_M[0], people.PERSON_SIZE_M[1], height)
        return Looks(
            category="person",
            mesh=mesh,
            size_m=size,
            gait=gait,
            disc_radius_m=0.38,
            disc_offsets_m=(0.0,),
            half_base_m=0.0,
        )
