# SPDX-License-Identifier: Apache-2.0
"""How a bay is furnished: an office with desks, a coffee corner, or a place to wait.

Bay frame: origin at the middle of the opening, x along the wall, y towards the corridor; the bay lies at y < 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.placement import planar_pose
from services.simulator.painting.indoor.library import SCREEN_COUNT
from services.simulator.shapes.meshes import Mesh
from services.simulator.shapes.things import furniture
from services.simulator.worlds.corridor.plan import Bay

Floats = NDArray[np.float64]

_DESK_DEPTH_M, _DESK_WIDTH_M, _DESK_TOP_M = furniture.DESK_SIZE_M


@dataclass(frozen=True, slots=True)
class Piece:
    """A thing that could be carried away: an object of its own. bay_from_object: 4x4."""

    category: str
    mesh: Mesh
    size_m: tuple[float, float, float]
    bay_from_object: Floats


@dataclass(frozen=True, slots=True)
class BayFurniture:
    """fixed: meshes in the bay's frame. pieces: objects. taken: discs (x, y, radius) where nobody can stand."""

    fixed: list[Mesh] = field(default_factory=list)
    pieces: list[Piece] = field(default_factory=list)
    taken: list[tuple[float, float, float]] = field(default_factory=list)


def bay_furniture(bay: Bay, seed: int, texture: Mapping[str, int]) -> BayFurniture:
    """The same for equal bays and seeds."""
    rng = np.random.default_rng([seed, 23, bay.side, round(100.0 * bay.begin_m)])
    found = BayFurniture()
    if bay.length_m > 4.4 and bay.depth_m > 3.2:
        _office(bay, rng, texture, found)
    elif rng.random() < 0.6:
        _coffee_corner(bay, texture, found)
    else:
        _waiting_corner(bay, rng, texture, found)
    for side in (-1.0, 1.0):
        if rng.random() < 0.6:
            place = planar_pose(np.array([side * (0.5 * bay.length_m - 0.4), -0.45]), 0.0)
            found.fixed.append(furniture.plant_mesh(rng, texture).transformed(place))
            found.taken.append((float(place[0, 3]), -0.45, 0.45))
    return found


def _office(bay: Bay, rng: np.random.Generator, texture: Mapping[str, int], found: BayFurniture) -> None:
    """A row of desks along the back wall, whoever sits there with the back to the corridor; shelves at the sides."""
    count = int((bay.length_m - 1.4) / (_DESK_WIDTH_M + 0.25))
    back = -bay.depth_m + 0.5 * _DESK_DEPTH_M + 0.3
    for number in range(count):
        x = (number - 0.5 * (count - 1)) * (_DESK_WIDTH_M + 0.25)
        desk = planar_pose(np.array([x, back]), 0.5 * np.pi)
        found.fixed.append(furniture.desk_mesh(texture).transformed(desk))
        found.taken.append((x, back, 0.9))
        for offset in (-0.3, 0.3) if rng.random() < 0.5 else (0.0,):
            place = planar_pose(np.array([x + offset, back - 0.2]), 0.5 * np.pi + float(rng.uniform(-0.15, 0.15)))
            place[2, 3] = _DESK_TOP_M
            mesh = furniture.screen_mesh(int(rng.integers(0, SCREEN_COUNT)), texture)
            found.pieces.append(Piece("tv", mesh, furniture.SCREEN_SIZE_M, place))
        seat = np.array([x + float(rng.uniform(-0.2, 0.2)), back + 0.75])
        _chair(seat, -0.5 * np.pi + float(rng.uniform(-0.7, 0.7)), rng, texture, found)
        if rng.random() < 0.6:
            aside = planar_pose(np.array([x + 0.85, back + 0.25]), 0.0)
            found.fixed.append(furniture.bin_mesh(texture).transformed(aside))
    for side in (-1.0, 1.0):
        shelf = furniture.cabinet_mesh((0.38, 1.0, 1.9), texture["books" if side > 0 else "cupboard"], texture["wood"])
        place = planar_pose(np.array([side * 0.5 * bay.length_m, -0.5 * bay.depth_m]), np.pi if side > 0 else 0.0)
        found.fixed.append(shelf.transformed(place))
        found.taken.append((side * (0.5 * bay.length_m - 0.2), -0.5 * bay.depth_m, 0.7))


def _coffee_corner(bay: Bay, texture: Mapping[str, int], found: BayFurniture) -> None:
    for x, face in ((-0.55, "machine"), (0.55, "cupboard")):
        cabinet = furniture.cabinet_mesh((0.7, 0.95, 1.85), texture[face], texture["dark"])
        found.fixed.append(cabinet.transformed(planar_pose(np.array([x, -bay.depth_m]), 0.5 * np.pi)))
        found.taken.append((x, -bay.depth_m + 0.35, 0.7))


def _waiting_corner(bay: Bay, rng: np.random.Generator, texture: Mapping[str, int], found: BayFurniture) -> None:
    for number in range(int((bay.length_m - 1.0) / 0.75)):
        x = -0.5 * bay.length_m + 0.8 + 0.75 * number
        seat = np.array([x, -bay.depth_m + 0.45])
        _chair(seat, 0.5 * np.pi + float(rng.uniform(-0.2, 0.2)), rng, texture, found)
    place = planar_pose(np.array([0.0, -bay.depth_m + 0.03]), 0.5 * np.pi)
    place[2, 3] = 1.5
    mesh = furniture.screen_mesh(int(rng.integers(0, SCREEN_COUNT)), texture)
    wide = np.diag([1.0, 2.0, 1.6, 1.0])
    depth, width, height = furniture.SCREEN_SIZE_M
    found.pieces.append(Piece("tv", mesh.transformed(wide), (depth, 2.0 * width, 1.6 * height), place))


def _chair(
    at: Floats, heading_rad: float, rng: np.random.Generator, texture: Mapping[str, int], found: BayFurniture
) -> None:
    b, g, r = rng.uniform(0.6, 1.5, 3).tolist()
    mesh = furniture.chair_mesh(texture, (b, g, r))
    found.pieces.append(Piece("chair", mesh, furniture.CHAIR_SIZE_M, planar_pose(at, heading_rad)))
    found.taken.append((float(at[0]), float(at[1]), 0.45))
