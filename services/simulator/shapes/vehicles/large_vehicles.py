# SPDX-License-Identifier: Apache-2.0
"""Buses, lorries and delivery vans. Object frame: x forward, y left, z up, origin on the ground below the middle."""

from __future__ import annotations

from collections.abc import Mapping

from services.simulator.shapes.meshes import WHITE, Mesh, Tint, blob, box, merged, tube
from services.simulator.shapes.vehicles.parts import body, upright, wheels

BUS_LIVERIES, BOX_ADVERTS, FIRMS, CARGOES = 3, 4, 3, 3
_DARK: Tint = (0.25, 0.25, 0.25)


def bus_mesh(livery: int, texture: Mapping[str, int]) -> Mesh:
    """A town bus of 10.8 m with doors on its right."""
    rear, front = -5.4, 5.4
    outline = (
        (rear + 0.05, 0.32),
        (rear, 1.0),
        (rear + 0.02, 2.72),
        (rear + 0.2, 2.98),
        (front - 0.3, 2.98),
        (front - 0.06, 2.74),
        (front, 1.15),
        (front - 0.03, 0.3),
    )
    roof = (texture["bus_roof"], WHITE)
    back, face = texture[f"bus_back_{livery}"], texture[f"bus_front_{livery}"]
    skins = [(texture["car_panel"], _DARK)] * 2 + [roof] * 3 + [(texture["car_panel"], _DARK)] * 2
    hull = body(outline, 1.25, (texture[f"bus_left_{livery}"], texture[f"bus_right_{livery}"]), skins, lean=0.03)
    pieces = [
        hull,
        upright(front + 0.02, (-1.23, 1.23), (0.36, 2.86), face),
        upright(rear - 0.02, (1.23, -1.23), (0.36, 2.86), back),
        box((2.6, 1.5, 0.16), (-1.6, 0.0, 2.97), texture["bus_roof"]),
        wheels((-2.95, 2.75), 1.252, 0.48, texture),
    ]
    pieces += [box((0.1, 0.22, 0.38), (front + 0.04, side * 1.3, 2.3), texture["rubber"]) for side in (-1.0, 1.0)]
    return merged(pieces)


def _cab(front: float, paint: Tint, texture: Mapping[str, int], half_m: float) -> list[Mesh]:
    """A lorry's cab, 1.9 m long."""
    rear = front - 1.9
    outline = (
        (rear, 0.55),
        (rear, 2.55),
        (rear + 0.15, 2.7),
        (front - 0.4, 2.66),
        (front - 0.12, 1.9),
        (front, 1.3),
        (front, 0.4),
    )
    panel = (texture["car_panel"], paint)
    skins = [panel] * 3 + [(texture["car_panel"], _DARK), panel, panel]
    hull = body(outline, half_m, (texture["cab_left"], texture["cab_right"]), skins, tint=paint, lean=0.06)
    mirrors = [box((0.08, 0.2, 0.4), (front - 0.3, side * (half_m + 0.1), 1.95), texture["rubber"]) for side in (-1, 1)]
    return [
        hull,
        upright(front + 0.02, (-half_m + 0.03, half_m - 0.03), (0.42, 2.6), texture["cab_front"], tint=paint),
        *mirrors,
    ]


def box_lorry_mesh(paint: Tint, advert: int, texture: Mapping[str, int]) -> Mesh:
    """A lorry of 7.9 m with a closed box."""
    half_m, length_m, low, high = 1.2, 5.75, 0.95, 3.3
    side = texture[f"lorry_side_{advert}"]
    outline = ((-3.95, low), (-3.95, high), (-3.95 + length_m, high), (-3.95 + length_m, low))
    plain = (texture["lorry_plain"], WHITE)
    hull = body(outline, half_m, (side, side), [plain, (texture["bus_roof"], WHITE), plain], lean=0.0)
    return merged(
        [
            hull,
            upright(-3.96, (half_m, -half_m), (low, high), texture["lorry_doors"]),
            box((7.4, 1.0, 0.35), (-0.2, 0.0, 0.75), texture["rubber"]),
            box((0.12, 2.3, 0.22), (-3.88, 0.0, 0.5), texture["lorry_bumper"]),
            *_cab(3.95, paint, texture, 1.15),
            *(box((1.7, 0.06, 0.4), (0.2, s * 1.1, 0.65), texture["metal"]) for s in (-1.0, 1.0)),
            wheels((-2.3, 2.3), 1.17, 0.47, texture, 0.3),
        ]
    )


def flatbed_mesh(paint: Tint, cargo: int, texture: Mapping[str, int]) -> Mesh:
    """A lorry of 7.6 m with an open bed that carries pipes, crates or bricks."""
    half_m = 1.18
    bed = [
        box((5.4, 2.3, 0.16), (-1.08, 0.0, 1.0), texture["boards"]),
        *(box((5.4, 0.05, 0.45), (-1.08, s * 1.15, 1.25), texture["lorry_plain"], tint=paint) for s in (-1.0, 1.0)),
        box((0.05, 2.3, 0.45), (-3.77, 0.0, 1.25), texture["lorry_plain"], tint=paint),
        box((0.08, 2.3, 1.4), (1.6, 0.0, 1.75), texture["metal"]),
        box((7.0, 1.0, 0.3), (-0.2, 0.0, 0.76), texture["rubber"]),
        box((0.12, 2.3, 0.2), (-3.72, 0.0, 0.55), texture["lorry_bumper"]),
    ]
    if cargo == 0:
        load = [
            tube((-3.6, y, z), (1.4, y, z), (0.24, 0.24), texture["metal"], 8, repeat=(2.0, 5.0))
            for y, z in ((-0.6, 1.33), (-0.05, 1.33), (0.5, 1.33), (-0.32, 1.8), (0.22, 1.8))
        ]
    elif cargo == 1:
        load = [
            box((1.1, 1.0, h), (x, y, 1.08 + 0.5 * h), texture["boards"], 0.8)
            for x, y, h in ((-3.0, 0.5, 1.1), (-3.0, -0.55, 0.8), (-1.6, 0.0, 1.3), (-0.2, 0.5, 0.9), (0.9, -0.4, 1.1))
        ]
    else:
        load = [box((1.2, 1.9, 0.9), (x, 0.0, 1.55), texture["wall"], 1.2) for x in (-2.9, -1.4, 0.2)]
        load.append(blob((0.0, 0.0, 2.0), (1.2, 0.7, 0.3), texture["bag"], sides=6))
    return merged([*bed, *load, *_cab(3.8, paint, texture, half_m), wheels((-2.2, 2.2), 1.15, 0.46, texture, 0.3)])


def delivery_mesh(paint: Tint, firm: int, texture: Mapping[str, int]) -> Mesh:
    """A high van of 5.7 m with a firm's name on it."""
    rear, front = -2.85, 2.85
    outline = (
        (rear, 0.4),
        (rear, 2.4),
        (rear + 0.15, 2.6),
        (1.0, 2.58),
        (1.35, 2.4),
        (2.05, 1.42),
        (2.72, 1.2),
        (front, 0.85),
        (front, 0.35),
    )
    panel = (texture["car_panel"], paint)
    skins = [panel, panel, panel, panel, (texture["town_glass"], WHITE), panel, (texture["car_front"], paint), panel]
    left, right = texture[f"delivery_left_{firm}"], texture[f"delivery_right_{firm}"]
    pieces = [
        body(outline, 1.02, (left, right), skins, tint=paint, lean=0.05),
        upright(rear - 0.02, (1.0, -1.0), (0.42, 2.5), texture["delivery_doors"], tint=paint),
        wheels((-1.75, 1.8), 1.03, 0.36, texture),
        upright(front + 0.02, (-0.27, 0.27), (0.5, 0.62), texture["plate"]),
    ]
    for side in (-1.0, 1.0):
        pieces.append(upright(front + 0.02, (side * 0.78 - 0.2, side * 0.78 + 0.2), (0.78, 0.98), texture["headlamp"]))
        pieces.append(box((0.1, 0.22, 0.34), (1.75, side * 1.12, 1.5), texture["rubber"]))
    return merged(pieces)
