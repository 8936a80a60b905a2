# SPDX-License-Identifier: Apache-2.0
"""Walls of town houses, storey by storey.

Object frame: x along the street, y towards it, z up, origin on the ground below the middle of the front; metres.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.painting.buildings.shopfronts import SHOP_M
from services.simulator.painting.buildings.storeys import BAYS, PLAIN_M, STOREY_M, TILE_M
from services.simulator.shapes.meshes import WHITE, Mesh, Tint, box, merged, quads, stretch

Floats = NDArray[np.float64]

BAY_M = TILE_M / BAYS
PLINTH_M = 0.35
"""How far the ground floor lies above the ground below the front."""
FOUNDATION_M = 1.7
"""How far walls go on below the ground, for houses on a slope."""


@dataclass(frozen=True, slots=True)
class Wall:
    """How the four walls of a house look; blank_sides: its sides are party walls."""

    style: str
    tint: Tint = WHITE
    first_bay: int = 0
    blank_sides: bool = False
    shop: int | None = None


def ring(size_m: tuple[float, float]) -> Floats:
    """Corners of a house `size_m` wide and deep, front first, (5, 2)."""
    half, depth = 0.5 * size_m[0], size_m[1]
    return np.array([[half, 0.0], [-half, 0.0], [-half, -depth], [half, -depth], [half, 0.0]])


def height_m(storeys: int, wall: Wall) -> float:
    """Of the eaves above the ground."""
    return PLINTH_M + storeys * STOREY_M + (SHOP_M[1] - STOREY_M if wall.shop is not None else 0.0)


def walls_mesh(size_m: tuple[float, float], storeys: int, wall: Wall, texture: Mapping[str, int]) -> Mesh:
    """Four walls with a plinth; ground floor, upper storeys, and a shop in front where there is one."""
    corners, uv, blank = [], [], []
    around = ring(size_m)
    for k in range(4):
        a, b = around[k], around[k + 1]
        length = float(np.linalg.norm(b - a))
        is_blank = wall.blank_sides and k in (1, 3)
        low = PLINTH_M
        for storey in range(storeys):
            shop = storey == 0 and wall.shop is not None
            high = low + (SHOP_M[1] if shop else STOREY_M)
            face = [[*a, high], [*b, high], [*b, low], [*a, low]]
            u0 = ((wall.first_bay + 3 * storey + k) % BAYS) / BAYS
            # No second door above or beside the first: only front and back have one, on the ground floor.
            ground = storey == 0 and k in (0, 2) and not shop
            v0, v1 = (0.5, 1.0) if ground else (0.0, 0.5)
            if is_blank or (shop and k != 0):
                blank.append((face, length, high - low))
            elif not shop:
                u1 = u0 + length / TILE_M
                corners.append(face)
                uv.append([[u0, v0], [u1, v0], [u1, v1], [u0, v1]])
            low = high
    plain = texture[f"plain_{wall.style}"]
    pieces = []
    if corners:
        pieces.append(quads(corners, uv, texture[f"storeys_{wall.style}"], wall.tint))
    if wall.shop is not None:
        pieces.append(_shop(size_m[0], wall.shop, texture))
    if blank:
        tiles = [stretch(w / PLAIN_M, h / PLAIN_M) for _, w, h in blank]
        pieces.append(quads([face for face, _, _ in blank], tiles, plain, wall.tint))
    pieces.append(_plinth(around, texture))
    return merged(pieces)


def _shop(width_m: float, number: int, texture: Mapping[str, int]) -> Mesh:
    """The front of a shop, its windows stretched to the house's width."""
    half, low, high = 0.5 * width_m, PLINTH_M, PLINTH_M + SHOP_M[1]
    face = [[half, 0.0, high], [-half, 0.0, high], [-half, 0.0, low], [half, 0.0, low]]
    return quads([face], stretch(), texture[f"shop_{number}"])


def _plinth(around: Floats, texture: Mapping[str, int]) -> Mesh:
    """The foot of the walls, a little before them, and the foundation below."""
    middle = around[:4].mean(axis=0)
    wide = middle + (around - middle) * (1.0 + 0.05 / np.abs(around - middle).clip(0.5))
    faces, uv = [], []
    for k in range(4):
        a, b = wide[k], wide[k + 1]
        length = float(np.linalg.norm(b - a)) / PLAIN_M
        faces.append([[*a, PLINTH_M], [*b, PLINTH_M], [*b, -FOUNDATION_M], [*a, -FOUNDATION_M]])
        uv.append(stretch(length, 0.7))
    faces.append([[*wide[k], PLINTH_M] for k in range(4)])
    uv.append(stretch(1, 0.1))
    return quads(faces, uv, texture["plain_sandstone"], (0.62, 0.62, 0.64))


def gable_mesh(corners: Floats, style: str, tint: Tint, texture: Mapping[str, int]) -> Mesh:
    """The triangle of wall under a roof; corners (3, 3): both eaves and the ridge."""
    width = float(np.linalg.norm(corners[1] - corners[0])) / PLAIN_M
    rise = float(corners[2, 2] - corners[0, 2]) / PLAIN_M
    uv = [[0, rise], [width, rise], [0.5 * width, 0], [0.5 * width, 0]]
    return quads([[*corners, corners[2]]], uv, texture[f"plain_{style}"], tint)


def cornice_mesh(size_m: tuple[float, float], at_m: float, texture: Mapping[str, int], high_m: float = 0.3) -> Mesh:
    """A ledge round the top of the walls."""
    size = (size_m[0] + 0.3, size_m[1] + 0.3, high_m)
    return box(size, (0.0, -0.5 * size_m[1], at_m), texture["plain_sandstone"], PLAIN_M, (1.05, 1.05, 1.05))
