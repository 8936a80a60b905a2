# SPDX-License-Identifier: Apache-2.0
"""Walls, and what hangs on them. Wall frame: x along the wall, y away from it, z up; seen from +y."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.placement import planar_pose
from services.simulator.painting.indoor.library import DOOR_COUNT, POSTER_COUNT
from services.simulator.shapes.meshes import Mesh, box, merged, quads
from services.simulator.shapes.things import furniture
from services.simulator.worlds.corridor.plan import CEILING_M

Floats = NDArray[np.float64]

_TILE_M = 4.0
_UPRIGHT = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def sheet(x: tuple[float, float], z: tuple[float, float], y: float, texture: int, depth_m: float = 0.0) -> Mesh:
    """A picture on the wall from x[0] to x[1] and z[0] to z[1], `y` before it, on a board `depth_m` thick."""
    corners = [[x[1], y, z[1]], [x[0], y, z[1]], [x[0], y, z[0]], [x[1], y, z[0]]]
    face = quads([corners], _UPRIGHT, texture)
    if not depth_m:
        return face
    size = (x[1] - x[0], depth_m, z[1] - z[0])
    board = box(size, (0.5 * (x[0] + x[1]), y - 0.5 * depth_m - 0.002, 0.5 * (z[0] + z[1])), texture, 4.0)
    return merged([face, board])


def bare_wall(x: tuple[float, float], y: float, texture: int, skirting: int) -> Mesh:
    """Paint from floor to ceiling and a skirting board; the paint runs on from one stretch of a wall to the next."""
    corners = [[x[1], y, CEILING_M], [x[0], y, CEILING_M], [x[0], y, 0.0], [x[1], y, 0.0]]
    u0, u1 = -x[1] / _TILE_M, -x[0] / _TILE_M
    paint = quads([corners], [[u0, 0], [u1, 0], [u1, 1], [u0, 1]], texture)
    board = box((x[1] - x[0], 0.02, 0.1), (0.5 * (x[0] + x[1]), y + 0.01, 0.05), skirting, 0.7)
    return merged([paint, board])


def hung_wall(
    rng: np.random.Generator, x: tuple[float, float], paint: int, texture: Mapping[str, int], *, windows: bool
) -> list[Mesh]:
    """A stretch of wall in the plane y = 0 with doors, posters and the like, one beside the other."""
    pieces = [bare_wall(x, 0.0, paint, texture["wood"])]
    at = x[0] + float(rng.uniform(0.3, 1.2))
    while True:
        kind = str(rng.choice(_KINDS_WITH_WINDOW if windows else _KINDS))
        width = _WIDTHS_M[kind]
        if at + width > x[1] - 0.25:
            return pieces
        pieces += _thing(rng, kind, (at, at + width), texture)
        at += width + float(rng.uniform(0.25, 1.3))


_WIDTHS_M = {"door": 0.95, "poster": 0.7, "pair": 1.25, "board": 1.4, "window": 1.5, "extinguisher": 0.3, "sign": 0.4}
_KINDS = ("door", "door", "poster", "poster", "pair", "board", "extinguisher", "sign")
_KINDS_WITH_WINDOW = ("window", "window", "poster", "pair", "door", "board", "extinguisher")


def _thing(rng: np.random.Generator, kind: str, x: tuple[float, float], texture: Mapping[str, int]) -> list[Mesh]:
    things: dict[str, Callable[[], list[Mesh]]] = {
        "door": lambda: _door(rng, x, texture),
        "window": lambda: _window(x, texture),
        "board": lambda: [sheet(x, (0.95, 1.95), 0.03, texture["notice_board"], 0.02)],
        "extinguisher": lambda: _extinguisher(x, texture),
        "sign": lambda: [sheet(x, (2.3, 2.5), 0.03, texture["exit_sign"], 0.02)],
        "pair": lambda: [
            _poster(rng, (x[0], x[0] + 0.55), 0.78, texture),
            _poster(rng, (x[0] + 0.65, x[1]), 0.6, texture),
        ],
        "poster": lambda: [_poster(rng, x, 0.98, texture)],
    }
    return things[kind]()


def _poster(rng: np.random.Generator, x: tuple[float, float], height_m: float, texture: Mapping[str, int]) -> Mesh:
    low, kind = float(rng.uniform(1.0, 1.25)), int(rng.integers(0, POSTER_COUNT))
    return sheet(x, (low, low + height_m), 0.02, texture[f"poster_{kind}"], 0.01)


def _door(rng: np.random.Generator, x: tuple[float, float], texture: Mapping[str, int]) -> list[Mesh]:
    kind = int(rng.integers(0, DOOR_COUNT))
    leaf = sheet((x[0] + 0.04, x[1] - 0.04), (0.0, 2.04), 0.035, texture[f"door_{kind}"])
    frame = [box((0.07, 0.08, 2.1), (side, 0.04, 1.05), texture["steel"], 0.5) for side in x]
    lintel = box((x[1] - x[0] + 0.07, 0.08, 0.07), (0.5 * (x[0] + x[1]), 0.04, 2.1), texture["steel"], 0.5)
    return [leaf, *frame, lintel]


def _window(x: tuple[float, float], texture: Mapping[str, int]) -> list[Mesh]:
    glass = sheet(x, (0.95, 2.3), 0.015, texture["window"], 0.01)
    sill = box((x[1] - x[0] + 0.1, 0.12, 0.03), (0.5 * (x[0] + x[1]), 0.06, 0.94), texture["plastic"], 0.6)
    return [glass, sill, sheet((x[0] + 0.1, x[1] - 0.1), (0.16, 0.72), 0.1, texture["radiator"], 0.09)]


def _extinguisher(x: tuple[float, float], texture: Mapping[str, int]) -> list[Mesh]:
    turned = planar_pose(np.array([0.5 * (x[0] + x[1]), 0.0]), 0.5 * np.pi)
    return [furniture.extinguisher_mesh(texture).transformed(turned), sheet(x, (1.3, 1.6), 0.01, texture["red"])]
