# SPDX-License-Identifier: Apache-2.0
"""The town's cars: bodies by `outlines` and what stands out of them. Object frame as in `cars`."""

from __future__ import annotations

from collections.abc import Mapping

from services.simulator.shapes.meshes import Mesh, Tint, box, merged
from services.simulator.shapes.vehicles.cars import car_mesh
from services.simulator.shapes.vehicles.outlines import BODIES

PAINTS: tuple[Tint, ...] = (
    (0.95, 0.95, 0.95),
    (0.88, 0.88, 0.86),
    (0.20, 0.20, 0.21),
    (0.34, 0.34, 0.36),
    (0.62, 0.62, 0.60),
    (0.74, 0.76, 0.76),
    (0.20, 0.18, 0.78),
    (0.16, 0.14, 0.48),
    (0.76, 0.38, 0.16),
    (0.44, 0.22, 0.10),
    (0.82, 0.62, 0.40),
    (0.22, 0.44, 0.24),
    (0.30, 0.66, 0.86),
    (0.18, 0.50, 0.90),
    (0.50, 0.62, 0.70),
    (0.36, 0.50, 0.52),
)
TAXI_PAINT: Tint = (0.62, 0.88, 0.98)


def town_car_mesh(name: str, paint: Tint, texture: Mapping[str, int]) -> Mesh:
    """A car of one of `BODIES` in a paint (factors of blue, green, red); taxis have their own."""
    body = car_mesh(BODIES[name], TAXI_PAINT if name == "taxi" else paint, texture, "town_glass")
    panel, dark = texture["car_panel"], texture["rubber"]
    if name == "taxi":
        sign = box((0.2, 0.5, 0.18), (-0.3, 0.0, 1.57), texture["plate"], 0.5, tint=(0.3, 0.9, 1.0))
        return merged([body, sign])
    if name == "pickup":
        bed = [
            box((1.5, 1.5, 0.02), (-1.72, 0.0, 1.11), dark),
            *(box((1.56, 0.1, 0.16), (-1.73, side * 0.84, 1.17), panel, tint=paint) for side in (-1.0, 1.0)),
            box((0.1, 1.6, 0.16), (-2.46, 0.0, 1.16), panel, tint=paint),
            box((0.9, 1.1, 0.4), (-1.5, 0.1, 1.3), texture["boards"]),
        ]
        return merged([body, *bed])
    if name in ("estate", "suv"):
        high = BODIES[name].size_m[2]
        rails = [box((1.7, 0.05, 0.05), (-0.8, side * 0.52, high + 0.0), dark) for side in (-1.0, 1.0)]
        return merged([body, *rails])
    return body
