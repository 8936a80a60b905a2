# SPDX-License-Identifier: Apache-2.0
"""Kinds of town houses put together from walls and roofs. Object frame: see `walls`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.painting.buildings.shopfronts import BOARDS, SHOP_M
from services.simulator.painting.buildings.storeys import STOREY_M
from services.simulator.shapes.buildings import roofs
from services.simulator.shapes.buildings.walls import (
    BAY_M,
    FOUNDATION_M,
    PLINTH_M,
    Wall,
    cornice_mesh,
    height_m,
    walls_mesh,
)
from services.simulator.shapes.meshes import Mesh, Tint, box, merged, quads, stretch

Size = tuple[float, float]
Textures = Mapping[str, int]


def terrace_mesh(
    rng: np.random.Generator, size_m: Size, storeys: int, *, wall: Wall, roof: str, texture: Textures
) -> Mesh:
    """One house of a row: ridge along the street or, now and then, a gable in front; chimney on the party wall."""
    top = height_m(storeys, wall)
    pieces = [walls_mesh(size_m, storeys, wall, texture)]
    pitch = float(rng.uniform(0.65, 0.85))
    if rng.random() < 0.2:
        pieces.append(roofs.cross_gable_roof(size_m, top, 1.1, roof=roof, wall=wall, texture=texture))
        return merged(pieces)
    pieces.append(roofs.gable_roof(size_m, top, pitch, roof=roof, wall=wall, texture=texture))
    ridge = top + 0.5 * size_m[1] * pitch
    at = (0.5 * size_m[0] - 0.5, -0.5 * size_m[1])
    pieces.append(roofs.chimney_mesh(at, top, ridge + 0.9, texture))
    if rng.random() < 0.5:
        x = float(rng.uniform(-0.2, 0.2)) * size_m[0]
        pieces.append(roofs.dormer_mesh(x, -0.6, top + 0.45, texture))
    pieces.append(_step(rng, size_m, texture))
    return merged(pieces)


def villa_mesh(
    rng: np.random.Generator, size_m: Size, storeys: int, *, wall: Wall, roof: str, texture: Textures
) -> Mesh:
    """A detached house with a hip, gable or cross gable roof, often with a porch or a bay."""
    top = height_m(storeys, wall)
    pieces = [walls_mesh(size_m, storeys, wall, texture)]
    kind, pitch = int(rng.integers(0, 3)), float(rng.uniform(0.65, 0.95))
    if kind == 0:
        pieces.append(roofs.hip_roof(size_m, top, pitch, texture[roof]))
    else:
        build = roofs.gable_roof if kind == 1 else roofs.cross_gable_roof
        pieces.append(build(size_m, top, pitch, roof=roof, wall=wall, texture=texture))
    span = {0: min(size_m), 1: size_m[1], 2: size_m[0]}[kind]
    pieces.append(
        roofs.chimney_mesh((0.15 * size_m[0], -0.4 * size_m[1]), top, top + 0.5 * span * pitch + 0.6, texture)
    )
    if rng.random() < 0.6:
        pieces.append(_bay(float(rng.choice([-0.25, 0.25])) * size_m[0], wall, texture[roof], texture))
    pieces.append(_step(rng, size_m, texture))
    return merged(pieces)


def flats_mesh(rng: np.random.Generator, size_m: Size, storeys: int, *, wall: Wall, texture: Textures) -> Mesh:
    """A block of flats: flat roof, balconies one above the other, an entrance with a canopy."""
    top = height_m(storeys, wall)
    pieces = [
        walls_mesh(size_m, storeys, wall, texture),
        roofs.flat_roof(size_m, top, wall.style, wall.tint, texture),
    ]
    bays = round(size_m[0] / BAY_M)
    railing = texture[str(rng.choice(["railing_white", "railing_green"]))]
    balcony = _balcony(railing, texture)
    for bay in range(int(rng.integers(0, 2)), bays, int(rng.integers(2, 4))):
        x = -0.5 * size_m[0] + (bay + 0.5) * BAY_M
        pieces += [balcony.transformed(_moved(x, 0.0, PLINTH_M + k * STOREY_M)) for k in range(1, storeys)]
    x = float(rng.uniform(-0.3, 0.3)) * size_m[0]
    pieces.append(box((3.4, 1.6, 0.2), (x, 0.8, 2.95), texture["plain_grey_panels"], 3.0))
    return merged(pieces)


def shop_mesh(
    rng: np.random.Generator, size_m: Size, storeys: int, *, wall: Wall, roof: str, texture: Textures
) -> Mesh:
    """A shop with flats above: name board across the pavement's edge, an awning, a mansard or gable roof."""
    top = height_m(storeys, wall)
    pieces = [walls_mesh(size_m, storeys, wall, texture), cornice_mesh(size_m, top - 0.1, texture)]
    if rng.random() < 0.55:
        pieces.append(roofs.mansard_roof(size_m, top, texture[roof], texture))
    else:
        pieces.append(roofs.gable_roof(size_m, top, 0.7, roof=roof, wall=wall, texture=texture))
    board = texture[f"board_{int(rng.integers(0, BOARDS))}"]
    x, z = float(rng.choice([-0.35, 0.35])) * size_m[0], PLINTH_M + SHOP_M[1] + 0.5
    for side in (-0.04, 0.04):
        # It reads from left to right on both sides.
        left, right = (0.2, 1.4) if side > 0 else (1.4, 0.2)
        face = [[x + side, dy, z + dz] for dy, dz in ((left, 0.7), (right, 0.7), (right, 0.0), (left, 0.0))]
        pieces.append(quads([face], stretch(), board))
    pieces.append(box((0.05, 1.4, 0.05), (x, 0.7, z + 0.73), texture["iron"]))
    if rng.random() < 0.7:
        pieces.append(_awning(rng, size_m[0], texture))
    return merged(pieces)


def hall_mesh(rng: np.random.Generator, size_m: Size, texture: Textures) -> Mesh:
    """A hall of sheet metal with gates and blank walls, a name along its top."""
    width, depth = size_m
    half, high = 0.5 * width, float(rng.uniform(5.5, 7.5))
    cladding = texture[str(rng.choice(["cladding_grey", "cladding_blue"]))]
    tone = float(rng.uniform(0.85, 1.1))
    pieces = [box((width, depth, high + FOUNDATION_M), (0.0, -0.5 * depth, 0.5 * (high - FOUNDATION_M)), cladding, 4.0)]
    pieces.append(box((width + 0.3, depth + 0.3, 0.5), (0.0, -0.5 * depth, high), cladding, 4.0, (tone, 0.7, 0.7)))
    for x in np.arange(-half + 3.5, half - 3.0, 7.0):
        if rng.random() < 0.65:
            face = [[x + dx, 0.04, z] for dx, z in ((2.0, 4.2), (-2.0, 4.2), (-2.0, 0.0), (2.0, 0.0))]
            pieces.append(quads([face], stretch(), texture["gate"]))
    board = texture[f"board_{int(rng.integers(0, BOARDS))}"]
    x = float(rng.uniform(-0.2, 0.2)) * width
    face = [[x + dx, 0.06, high + z] for dx, z in ((-3.2, -0.1), (3.2, -0.1), (3.2, -1.1), (-3.2, -1.1))]
    pieces.append(quads([[face[1], face[0], face[3], face[2]]], stretch(), board))
    return merged(pieces)


def church_mesh(texture: Textures, style: str, roof: str) -> Mesh:
    """A nave and a tower with a spire, which is seen from all over the town."""
    nave, tower = (11.0, 22.0), (6.0, 6.0)
    wall = Wall(style, blank_sides=False)
    parts = [walls_mesh(nave, 3, Wall(style), texture)]
    parts.append(roofs.gable_roof((nave[0], nave[1]), height_m(3, wall), 0.55, roof=roof, wall=wall, texture=texture))
    shaft = walls_mesh(tower, 7, Wall(style, blank_sides=True), texture)
    high = height_m(7, wall)
    parts.append(shaft.transformed(_moved(0.0, 4.0)))
    parts.append(cornice_mesh(tower, high, texture).transformed(_moved(0.0, 4.0)))
    parts.append(roofs.hip_roof(tower, high + 0.2, 3.6, texture["roof_slate"]).transformed(_moved(0.0, 4.0)))
    return merged(parts)


def _moved(x: float, y: float, z: float = 0.0) -> NDArray[np.float64]:
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def _step(rng: np.random.Generator, size_m: Size, texture: Textures) -> Mesh:
    x = float(rng.uniform(-0.3, 0.3)) * size_m[0]
    return box((1.6, 0.7, 0.6), (x, 0.0, 0.0), texture["plain_sandstone"], 3.0, (0.8, 0.8, 0.8))


def _bay(x: float, wall: Wall, roof: int, texture: Textures) -> Mesh:
    """A bay before the ground floor with windows on its front."""
    body = box((2.6, 1.0, 3.3), (x, 0.5, 1.3), texture[f"plain_{wall.style}"], 3.0, wall.tint)
    face = [[x + dx, 1.01, z] for dx, z in ((1.3, 2.95), (-1.3, 2.95), (-1.3, 0.35), (1.3, 0.35))]
    window = quads([face], [[0.02, 0.03], [0.23, 0.03], [0.23, 0.46], [0.02, 0.46]], texture[f"storeys_{wall.style}"])
    lid = quads(
        [[[x - 1.5, 0.0, 3.6], [x + 1.5, 0.0, 3.6], [x + 1.5, 1.25, 2.9], [x - 1.5, 1.25, 2.9]]],
        stretch(0.7, 0.4),
        roof,
    )
    return merged([body, window, lid])


def _balcony(railing: int, texture: Textures) -> Mesh:
    """Slab and railing, 2.6 m wide and 1.2 m deep, its floor at z = 0."""
    slab = box((2.6, 1.2, 0.16), (0.0, 0.6, 0.0), texture["plain_grey_panels"], 3.0)
    a, b, low, high = -1.3, 1.3, 0.08, 1.05
    faces = [
        [[a, 1.2, high], [b, 1.2, high], [b, 1.2, low], [a, 1.2, low]],
        [[a, 0.0, high], [a, 1.2, high], [a, 1.2, low], [a, 0.0, low]],
        [[b, 0.0, high], [b, 1.2, high], [b, 1.2, low], [b, 0.0, low]],
    ]
    return merged([slab, quads(faces, [stretch(width) for width in (1.3, 0.6, 0.6)], railing)])


def _awning(rng: np.random.Generator, width_m: float, texture: Textures) -> Mesh:
    """Striped cloth over the shop windows, 1.4 m out."""
    cloth = texture[str(rng.choice(["paint_red", "paint_yellow", "paint_green"]))]
    half, stripes = 0.42 * width_m, 12
    edges = np.linspace(-half, half, stripes + 1)
    pieces = []
    for k in range(stripes):
        a, b = float(edges[k]), float(edges[k + 1])
        tint: Tint = (1.0, 1.0, 1.0) if k % 2 else (1.25, 1.6, 1.4)
        slope = [[a, 0.05, 3.15], [b, 0.05, 3.15], [b, 1.4, 2.75], [a, 1.4, 2.75]]
        hem = [[a, 1.4, 2.75], [b, 1.4, 2.75], [b, 1.4, 2.5], [a, 1.4, 2.5]]
        colour = cloth if k % 2 else texture["worn_paint"]
        pieces.append(quads([slope, hem], stretch(0.5, 1), colour, tint if k % 2 else (1, 1, 1)))
    return merged(pieces)
