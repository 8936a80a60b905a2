# SPDX-License-Identifier: Apache-2.0
"""Houses with gable roofs, and the garden walls and hedges before them.

Object frame: x along the street, y towards the street, z up, origin below the middle of the front; metres.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from services.simulator.painting.buildings.facades import FACADE_WIDTH_M, FacadeStyle
from services.simulator.shapes.meshes import Mesh, Tint, box, merged, quads

_EAVES_M = 0.45


def house_mesh(
    style: FacadeStyle,
    size_m: tuple[float, float],
    roof: str,
    texture: Mapping[str, int],
    *,
    first_bay: int,
    tint: Tint,
) -> Mesh:
    """A house of `style`, `size_m` wide and deep.

    The front begins with window bay `first_bay` of its texture, so that neighbours of one style differ.
    """
    front = texture[f"facade_{style.name}"]
    width_m, depth_m = size_m
    height, ridge = style.height_m, style.height_m + 0.42 * depth_m
    u0 = 0.25 * first_bay
    half = 0.5 * width_m
    walls = []
    ring = np.array([[half, 0.0], [-half, 0.0], [-half, -depth_m], [half, -depth_m], [half, 0.0]])
    for k, length in enumerate((width_m, depth_m, width_m, depth_m)):
        a, b = ring[k], ring[k + 1]
        corners = [[*a, height], [*b, height], [*b, 0.0], [*a, 0.0]]
        u1 = u0 + length / FACADE_WIDTH_M
        walls.append(quads([corners], [[u0, 0], [u1, 0], [u1, 1], [u0, 1]], front, tint))
    for x in (-half, half):
        gable = [[x, 0.0, height], [x, -depth_m, height], [x, -0.5 * depth_m, ridge], [x, -0.5 * depth_m, ridge]]
        width = depth_m / FACADE_WIDTH_M
        strip = [[0, 0.03], [width, 0.03], [0.5 * width, 0.08], [0.5 * width, 0.08]]
        walls.append(quads([gable], strip, front, tint))
    slope = (ridge - height) / (0.5 * depth_m)
    low = height - _EAVES_M * slope
    wide = half + 0.3
    tiles = (2.0 * wide / 4.0, np.hypot(0.5 * depth_m + _EAVES_M, ridge - low) / 4.0)
    uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * tiles
    for y in (_EAVES_M, -depth_m - _EAVES_M):
        ridge_y = -0.5 * depth_m
        plane = [[-wide, ridge_y, ridge], [wide, ridge_y, ridge], [wide, y, low], [-wide, y, low]]
        walls.append(quads([plane], uv, texture[roof]))
    chimney = (0.3 * width_m, -0.36 * depth_m, ridge - 0.3)
    walls.append(box((0.7, 0.6, 1.6), chimney, texture["wall"], 3.0))
    walls.append(box((2.0 * wide, 0.12, 0.14), (0.0, _EAVES_M, low), texture["metal"]))
    return merged(walls)


def fence_mesh(kind: int, length_m: float, texture: Mapping[str, int]) -> Mesh:
    """Hedge (0), garden wall (1) or board fence (2) of a front garden."""
    if kind == 0:
        return box((length_m, 0.7, 1.25), (0.0, 0.0, 0.62), texture["leaves_dark"], 1.3)
    if kind == 1:
        wall = box((length_m, 0.25, 0.9), (0.0, 0.0, 0.45), texture["wall"], 3.0)
        return merged([wall, box((length_m + 0.1, 0.35, 0.08), (0.0, 0.0, 0.94), texture["paving"], 4.0)])
    posts = [
        box((0.12, 0.14, 1.2), (x, 0.0, 0.6), texture["boards"], 2.0)
        for x in np.arange(-0.5 * length_m, 0.5 * length_m + 0.1, 1.8)
    ]
    return merged([box((length_m, 0.05, 1.0), (0.0, 0.0, 0.56), texture["boards"], 2.0), *posts])
