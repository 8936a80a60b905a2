# SPDX-License-Identifier: Apache-2.0
"""Things that a town has once. Object frame: x along the street, y towards it, z up, origin on the ground; metres."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from services.simulator.shapes.meshes import Mesh, blob, box, merged, quads, stretch, tube

Textures = Mapping[str, int]
_ROOT_M = -0.8


def water_tower(texture: Textures) -> Mesh:
    """A tank on six legs, 24 m."""
    iron, tank = texture["iron"], texture["cladding_grey"]
    pieces = []
    for k in range(6):
        c, s = np.cos(k * np.pi / 3.0), np.sin(k * np.pi / 3.0)
        pieces.append(tube((3.6 * c, 3.6 * s, _ROOT_M), (2.6 * c, 2.6 * s, 16.0), (0.22, 0.18), iron, 6))
    for z in (5.5, 11.0):
        pieces.append(tube((0, 0, z), (0, 0, z + 0.3), (3.4, 3.4), iron, 12))
    pieces.append(tube((0, 0, _ROOT_M), (0, 0, 16.0), (0.6, 0.6), texture["plain_grey_panels"], 8, repeat=(2.0, 6.0)))
    pieces.append(tube((0, 0, 14.6), (0, 0, 16.2), (2.2, 4.2), tank, 14, repeat=(7.0, 0.5), caps=False))
    pieces.append(tube((0, 0, 16.2), (0, 0, 21.5), (4.2, 4.2), tank, 14, repeat=(7.0, 1.4), caps=False))
    pieces.append(tube((0, 0, 21.5), (0, 0, 24.0), (4.5, 0.2), texture["roof_red"], 14, repeat=(6.0, 1.2)))
    return merged(pieces)


def monument(texture: Textures) -> Mesh:
    """A statue on a column above three steps, 11 m."""
    stone, bronze = texture["plain_sandstone"], texture["paint_green"]
    pieces = [box((w, w, 0.5), (0, 0, z), stone, 3.0) for w, z in ((6.0, 0.0), (4.8, 0.4), (3.6, 0.8))]
    pieces.append(box((2.4, 2.4, 1.6), (0, 0, 1.8), stone, 3.0, (0.85, 0.85, 0.85)))
    pieces.append(
        quads(
            [[[0.8, 1.21, 2.3], [-0.8, 1.21, 2.3], [-0.8, 1.21, 1.4], [0.8, 1.21, 1.4]]], stretch(), texture["board_1"]
        )
    )
    pieces.append(tube((0, 0, 2.6), (0, 0, 8.2), (0.75, 0.6), stone, 12, repeat=(2.0, 3.0)))
    pieces.append(box((1.7, 1.7, 0.35), (0, 0, 8.35), stone, 3.0))
    pieces.append(tube((0, 0, 8.5), (0, 0, 9.9), (0.45, 0.3), bronze, 8))
    pieces.append(blob((0, 0, 10.4), (0.26, 0.28, 0.34), bronze, sides=8))
    pieces.append(tube((0.25, 0, 9.7), (0.9, 0.3, 10.6), (0.12, 0.09), bronze, 6))
    return merged(pieces)


def kiosk(texture: Textures) -> Mesh:
    """A kiosk hung with posters and boards, an octagonal roof."""
    pieces = [tube((0, 0, _ROOT_M), (0, 0, 2.7), (2.2, 2.2), texture["boards"], 8, repeat=(6.0, 1.5))]
    for k, name in enumerate(("poster_0", "shop_0", "poster_3", "poster_5")):
        angle = 0.25 * np.pi * (2 * k + 1) - 0.125 * np.pi
        a, b = angle - 0.3, angle + 0.3
        face = [[2.25 * np.cos(t), 2.25 * np.sin(t), z] for t, z in ((a, 2.3), (b, 2.3), (b, 0.9), (a, 0.9))]
        pieces.append(quads([face], stretch(0.5 if name == "shop_0" else 1.0), texture[name]))
    pieces.append(tube((0, 0, 2.7), (0, 0, 4.4), (3.0, 0.15), texture["roof_moss"], 8, repeat=(5.0, 1.0)))
    return merged(pieces)


def gas_holder(texture: Textures) -> Mesh:
    """A round tank in a frame of posts, 14 m high."""
    iron = texture["iron"]
    pieces = [tube((0, 0, _ROOT_M), (0, 0, 10.0), (8.0, 8.0), texture["cladding_blue"], 24, repeat=(12.0, 2.6))]
    pieces.append(tube((0, 0, 10.0), (0, 0, 11.2), (8.0, 0.3), texture["cladding_grey"], 24, repeat=(8.0, 1.0)))
    for k in range(12):
        c, s = np.cos(k * np.pi / 6.0), np.sin(k * np.pi / 6.0)
        pieces.append(tube((8.7 * c, 8.7 * s, _ROOT_M), (8.7 * c, 8.7 * s, 14.0), (0.2, 0.2), iron, 5))
    for z in (5.0, 9.5, 13.7):
        pieces.append(tube((0, 0, z), (0, 0, z + 0.35), (8.75, 8.75), iron, 24, caps=False))
    return merged(pieces)


def crane(texture: Textures) -> Mesh:
    """A tower crane of 28 m over an unfinished house."""
    yellow = texture["paint_yellow"]
    pieces = [box((0.25, 0.25, 28.0), (dx, dy, 13.5), yellow, 2.0) for dx in (-0.7, 0.7) for dy in (-0.7, 0.7)]
    for z in np.arange(1.0, 26.0, 1.6):
        pieces.append(tube((-0.7, 0.7, z), (0.7, 0.7, z + 1.6), (0.06, 0.06), yellow, 3, caps=False))
        pieces.append(tube((-0.7, -0.7, z + 1.6), (-0.7, 0.7, z), (0.06, 0.06), yellow, 3, caps=False))
    pieces.append(box((30.0, 0.5, 0.5), (8.0, 0, 26.5), yellow, 2.0))
    pieces.append(box((3.0, 1.6, 2.0), (-6.0, 0, 25.8), texture["plain_grey_panels"], 3.0))
    pieces.append(box((0.06, 0.06, 9.0), (17.0, 0, 22.0), texture["rubber"], 1.0))
    for storey in range(3):
        pieces.append(box((9.0, 7.0, 0.3), (0, -5.6, 0.2 + 3.0 * storey), texture["plain_grey_panels"], 3.0))
        for x in (-4.2, 0.0, 4.2):
            for y in (-2.6, -8.6):
                pieces.append(box((0.4, 0.4, 2.8), (x, y, 1.6 + 3.0 * storey), texture["plain_grey_panels"], 3.0))
    return merged(pieces)


KINDS: dict[str, tuple[Callable[[Textures], Mesh], tuple[float, float], float]] = {
    "water_tower": (water_tower, (9.5, 9.5), 0.0),
    "monument": (monument, (7.0, 7.0), 0.0),
    "kiosk": (kiosk, (6.5, 6.5), 0.0),
    "gas_holder": (gas_holder, (18.5, 18.5), 0.0),
    "crane": (crane, (11.0, 13.0), -4.0),
}
"""How each is built, and its footprint: width and depth round (0, y)."""
