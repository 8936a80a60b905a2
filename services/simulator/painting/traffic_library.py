# SPDX-License-Identifier: Apache-2.0
"""The textures of the town's vehicles and people by name, all painted from the seed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from services.simulator.painting.clothes import cloth_painters
from services.simulator.painting.surfaces import Image
from services.simulator.painting.vehicles import large_vehicle_textures as large
from services.simulator.painting.vehicles import vehicle_textures
from services.simulator.shapes.vehicles.large_vehicles import BOX_ADVERTS, BUS_LIVERIES, FIRMS
from services.simulator.shapes.vehicles.outlines import BODIES


def paint_traffic(seed: int) -> dict[str, Image]:
    """Textures beside those of `library.paint_shared`, name to BGR uint8 image."""
    painters: dict[str, Callable[[np.random.Generator], Image]] = dict(cloth_painters())
    for name, style in BODIES.items():
        painters[f"side_{name}"] = partial(vehicle_textures.paint_side, style=style)
    for k in range(BUS_LIVERIES):
        painters[f"bus_left_{k}"] = partial(large.paint_bus_side, livery=k, doors=False)
        painters[f"bus_right_{k}"] = partial(large.paint_bus_side, livery=k, doors=True)
        painters[f"bus_front_{k}"] = partial(large.paint_bus_front, livery=k)
        painters[f"bus_back_{k}"] = partial(large.paint_bus_back, livery=k)
    for k in range(BOX_ADVERTS):
        painters[f"lorry_side_{k}"] = partial(large.paint_lorry_side, number=k)
    for k in range(FIRMS):
        painters[f"delivery_left_{k}"] = partial(large.paint_delivery_side, firm=k, doors=False)
        painters[f"delivery_right_{k}"] = partial(large.paint_delivery_side, firm=k, doors=True)
    painters["town_glass"] = large.paint_glass
    painters["cab_left"] = partial(large.paint_cab_side, right=False)
    painters["cab_right"] = partial(large.paint_cab_side, right=True)
    painters["cab_front"] = large.paint_cab_front
    painters["lorry_doors"] = partial(large.paint_doors, colour=(206.0, 208.0, 208.0), windows=False)
    painters["delivery_doors"] = partial(large.paint_doors, colour=(218.0, 218.0, 218.0), windows=True)
    painters["lorry_bumper"] = large.paint_bumper
    painters["lorry_plain"] = partial(large.paint_plain, colour=(196.0, 198.0, 198.0))
    painters["bus_roof"] = partial(large.paint_plain, colour=(186.0, 188.0, 188.0))
    return {name: paint(np.random.default_rng([seed, 24, *name.encode()])) for name, paint in painters.items()}
