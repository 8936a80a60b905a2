# SPDX-License-Identifier: Apache-2.0
"""Everything of the floor that never moves: floor, ceiling, lamps, walls and what is fixed in the bays."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.painting.indoor.library import WALL_COUNT
from services.simulator.shapes.meshes import Mesh, box, merged, quads
from services.simulator.worlds.corridor.bays import bay_furniture
from services.simulator.worlds.corridor.plan import CEILING_M, HALF_WIDTH_M, Bay, FloorPlan, Wall
from services.simulator.worlds.corridor.walls import bare_wall, hung_wall

Floats = NDArray[np.float64]

_LAMP_EVERY_M = 2.4


def corridor_mesh(plan: FloorPlan, seed: int, texture: Mapping[str, int]) -> Mesh:
    """The floor as one mesh in the world frame."""
    rng = np.random.default_rng([seed, 22])
    cover = texture["carpet" if rng.random() < 0.5 else "tiles"]
    pieces = [_floor_and_ceiling(plan, cover, texture), _lamps(plan, texture)]
    for side, wall in enumerate(plan.outer):
        paint = texture[f"wall_{int(rng.integers(0, WALL_COUNT))}"]
        bays = sorted((bay for bay in plan.bays if bay.side == side), key=lambda bay: bay.begin_m)
        cuts = [0.0, *(edge for bay in bays for edge in (bay.begin_m, bay.begin_m + bay.length_m)), wall.length_m]
        for stretch in zip(cuts[::2], cuts[1::2], strict=True):
            hung = hung_wall(rng, stretch, paint, texture, windows=side % 2 == 0)
            pieces += [mesh.transformed(wall.world_from_wall) for mesh in hung]
        for bay in bays:
            fixed = merged([_bay_walls(bay, rng, paint, texture), *bay_furniture(bay, seed, texture).fixed])
            pieces.append(fixed.transformed(plan.world_from_bay(bay)))
    for wall in plan.inner:
        paint = texture[f"wall_{int(rng.integers(0, WALL_COUNT))}"]
        hung = hung_wall(rng, (0.0, wall.length_m), paint, texture, windows=False)
        pieces += [mesh.transformed(wall.world_from_wall) for mesh in hung]
    return merged(pieces)


def _flat(x: tuple[float, float], y: tuple[float, float], z: float, texture: int, tile_m: float) -> Mesh:
    corners = np.array([[x[0], y[0], z], [x[1], y[0], z], [x[1], y[1], z], [x[0], y[1], z]])
    return quads([corners], corners[:, :2] / tile_m, texture)


def _floor_and_ceiling(plan: FloorPlan, cover: int, texture: Mapping[str, int]) -> Mesh:
    out = 2.0 * HALF_WIDTH_M
    width, height = plan.size_m
    strips = [
        ((-out, width + out), (-out, 0.0)),
        ((-out, width + out), (height, height + out)),
        ((-out, 0.0), (0.0, height)),
        ((width, width + out), (0.0, height)),
    ]
    pieces = []
    for x, y in strips:
        pieces.append(_flat(x, y, 0.0, cover, 4.0).transformed(plan.world_from_plan))
        pieces.append(_flat(x, y, CEILING_M, texture["ceiling"], 2.4).transformed(plan.world_from_plan))
    for bay in plan.bays:
        half = 0.5 * bay.length_m
        for z, name, tile_m in ((0.0, "carpet", 3.1), (CEILING_M, "ceiling", 2.4)):
            flat = _flat((-half, half), (-bay.depth_m, 0.0), z, texture[name], tile_m)
            pieces.append(flat.transformed(plan.world_from_bay(bay)))
    return merged(pieces)


def _lamps(plan: FloorPlan, texture: Mapping[str, int]) -> Mesh:
    """A row along the corridor, which is never bent where one hangs, and one or two in each bay."""
    pieces = []
    for wall in plan.inner:
        for x in np.arange(0.5 * _LAMP_EVERY_M, wall.length_m, _LAMP_EVERY_M):
            pieces.append(_lamp((float(x), HALF_WIDTH_M), texture).transformed(wall.world_from_wall))
    for bay in plan.bays:
        for x in (-0.25, 0.25) if bay.length_m > 4.5 else (0.0,):
            lamp = _lamp((x * bay.length_m, -0.5 * bay.depth_m), texture)
            pieces.append(lamp.transformed(plan.world_from_bay(bay)))
    return merged(pieces)


def _lamp(at: tuple[float, float], texture: Mapping[str, int]) -> Mesh:
    glow = box((1.2, 0.3, 0.04), (*at, CEILING_M - 0.02), texture["lamp"], 1.0, (1.25, 1.25, 1.25))
    return merged([glow, box((1.24, 0.34, 0.02), (*at, CEILING_M - 0.005), texture["steel"], 0.5)])


def _bay_walls(bay: Bay, rng: np.random.Generator, paint: int, texture: Mapping[str, int]) -> Mesh:
    """Back and both sides, in the bay's frame; the back has windows."""
    half = 0.5 * bay.length_m
    back = Wall(_placed(0.0, (0.0, -bay.depth_m)), bay.length_m)
    pieces = [
        mesh.transformed(back.world_from_wall) for mesh in hung_wall(rng, (-half, half), paint, texture, windows=True)
    ]
    for turn, x in ((-0.5 * np.pi, -half), (0.5 * np.pi, half)):
        begin = (-bay.depth_m, 0.0) if turn > 0 else (0.0, bay.depth_m)
        side = bare_wall(begin, 0.0, paint, texture["wood"])
        pieces.append(side.transformed(_placed(turn, (x, 0.0))))
    return merged(pieces)


def _placed(turn_rad: float, xy: tuple[float, float]) -> Floats:
    pose = np.eye(4)
    cos, sin = np.cos(turn_rad), np.sin(turn_rad)
    pose[:2, :2], pose[:2, 3] = [[cos, -sin], [sin, cos]], xy
    return pose
