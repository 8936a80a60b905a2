# SPDX-License-Identifier: Apache-2.0
"""Roofs of town houses. Object frame: see `walls`; `eaves_m` is the height of the walls."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from services.simulator.shapes.buildings.walls import Wall, gable_mesh
from services.simulator.shapes.meshes import WHITE, Mesh, Tint, box, merged, quads, stretch

_TILE_M = 4.0
_OVERHANG_M = 0.4
Size = tuple[float, float]


def _slope(corners: ArrayLike, texture: int, tint: Tint = WHITE) -> Mesh:
    """A roof plane (4 corners: the upper edge, then the lower one backwards), tiles in rows along the eaves."""
    points = np.asarray(corners, np.float64)
    along = points[2] - points[3]
    along /= np.linalg.norm(along)
    rows = (points - points[3]) @ along
    fall = np.linalg.norm(points - points[3] - rows[:, None] * along, axis=1)
    uv = np.stack([rows, -fall], axis=1) / _TILE_M
    return quads([points], uv, texture, tint)


def gable_roof(
    size_m: Size, eaves_m: float, pitch: float, *, roof: str, wall: Wall, texture: Mapping[str, int]
) -> Mesh:
    """Ridge along the street; gables to both sides."""
    width, depth = size_m
    half, back = 0.5 * width, -0.5 * depth
    ridge = eaves_m + 0.5 * depth * pitch
    low, out = eaves_m - _OVERHANG_M * pitch, half + 0.15
    pieces = []
    for y in (_OVERHANG_M, -depth - _OVERHANG_M):
        pieces.append(_slope([[-out, back, ridge], [out, back, ridge], [out, y, low], [-out, y, low]], texture[roof]))
    for x in (-half, half):
        corners = np.array([[x, 0.0, eaves_m], [x, -depth, eaves_m], [x, back, ridge]])
        pieces.append(gable_mesh(corners, wall.style, wall.tint, texture))
    pieces.append(box((2.0 * out, 0.14, 0.14), (0.0, _OVERHANG_M, low), texture["metal"]))
    return merged(pieces)


def cross_gable_roof(
    size_m: Size, eaves_m: float, pitch: float, *, roof: str, wall: Wall, texture: Mapping[str, int]
) -> Mesh:
    """Ridge towards the street; a gable faces it."""
    width, depth = size_m
    half = 0.5 * width
    ridge = eaves_m + half * pitch
    low, out = eaves_m - _OVERHANG_M * pitch, half + _OVERHANG_M
    near, far = 0.25, -depth - 0.25
    pieces = []
    for x in (-out, out):
        pieces.append(_slope([[0.0, near, ridge], [0.0, far, ridge], [x, far, low], [x, near, low]], texture[roof]))
    for y in (0.0, -depth):
        corners = np.array([[half, y, eaves_m], [-half, y, eaves_m], [0.0, y, ridge]])
        pieces.append(gable_mesh(corners, wall.style, wall.tint, texture))
    return merged(pieces)


def hip_roof(size_m: Size, eaves_m: float, pitch: float, roof: int) -> Mesh:
    """Four slopes."""
    width, depth = size_m
    half, run = 0.5 * width, 0.5 * min(width, depth)
    ridge = eaves_m + run * pitch
    low, o = eaves_m - _OVERHANG_M * pitch, _OVERHANG_M
    a, b, c, d = (
        [x, y, low] for x, y in ((half + o, o), (-half - o, o), (-half - o, -depth - o), (half + o, -depth - o))
    )
    if width >= depth:
        p, q = [half - run, -0.5 * depth, ridge], [-half + run, -0.5 * depth, ridge]
        planes = ([q, p, a, b], [q, q, b, c], [p, q, c, d], [p, p, d, a])
    else:
        p, q = [0.0, -run, ridge], [0.0, -depth + run, ridge]
        planes = ([p, p, a, b], [p, q, c, b], [q, q, c, d], [p, q, d, a])
    return merged([_slope(plane, roof) for plane in planes])


def mansard_roof(size_m: Size, eaves_m: float, roof: int, texture: Mapping[str, int]) -> Mesh:
    """A steep lower roof with dormers and a flat top."""
    width, depth = size_m
    half, high, step = 0.5 * width, eaves_m + 2.5, 0.9
    outer = np.array([[half, 0.15], [-half, 0.15], [-half, -depth - 0.15], [half, -depth - 0.15]])
    inner = np.array([[half, -step], [-half, -step], [-half, -depth + step], [half, -depth + step]])
    pieces = []
    for k in range(4):
        n = (k + 1) % 4
        pieces.append(_slope([[*inner[k], high], [*inner[n], high], [*outer[n], eaves_m], [*outer[k], eaves_m]], roof))
    pieces.append(quads([[[*corner, high] for corner in inner]], stretch(3, 3), texture["gravel"]))
    for x in np.arange(-half + 1.5, half - 1.0, 3.0):
        pieces.append(dormer_mesh(float(x), -0.1, eaves_m + 0.25, texture))
    return merged(pieces)


def flat_roof(size_m: Size, eaves_m: float, style: str, tint: Tint, texture: Mapping[str, int]) -> Mesh:
    """Gravel behind a parapet, a stair house, a chimney."""
    width, depth = size_m
    half = 0.5 * width
    edge = texture[f"plain_{style}"]
    pieces = [
        quads(
            [[[half, 0, eaves_m], [-half, 0, eaves_m], [-half, -depth, eaves_m], [half, -depth, eaves_m]]],
            stretch(width / 3, depth / 3),
            texture["gravel"],
        )
    ]
    top = eaves_m + 0.25
    for size, centre in (
        ((width + 0.2, 0.25, 0.7), (0.0, 0.0, top)),
        ((width + 0.2, 0.25, 0.7), (0.0, -depth, top)),
        ((0.25, depth, 0.7), (-half, -0.5 * depth, top)),
        ((0.25, depth, 0.7), (half, -0.5 * depth, top)),
        ((3.0, 3.0, 2.6), (0.2 * width, -0.5 * depth, eaves_m + 1.3)),
    ):
        pieces.append(box(size, centre, edge, 3.0, (0.85 * tint[0], 0.85 * tint[1], 0.85 * tint[2])))
    pieces.append(box((0.8, 0.8, 1.6), (-0.3 * width, -0.6 * depth, eaves_m + 0.8), texture["wall"], 3.0))
    return merged(pieces)


def dormer_mesh(x: float, front_y: float, low_m: float, texture: Mapping[str, int]) -> Mesh:
    """A small window house on a roof: front at `front_y`, sill at `low_m`."""
    # The window is cut out of a painted storey; the bay's middle is 1.5 m from its edge.
    face = [[x + dx, front_y + 0.01, low_m + dz] for dx, dz in ((0.6, 1.55), (-0.6, 1.55), (-0.6, 0.0), (0.6, 0.0))]
    window = quads([face], [[0.07, 0.09], [0.18, 0.09], [0.18, 0.36], [0.07, 0.36]], texture["storeys_white_plaster"])
    body = box((1.3, 2.2, 1.6), (x, front_y - 1.1, low_m + 0.78), texture["plain_white_plaster"], 3.0)
    lid = box((1.6, 2.5, 0.12), (x, front_y - 1.05, low_m + 1.62), texture["roof_slate"], 4.0)
    return merged([window, body, lid])


def chimney_mesh(at_m: tuple[float, float], low_m: float, top_m: float, texture: Mapping[str, int]) -> Mesh:
    """A brick chimney with two pots, from below the roof to `top_m`."""
    x, y = at_m
    pots = [box((0.22, 0.22, 0.4), (x + dx, y, top_m + 0.2), texture["plain_red_brick"], 3.0) for dx in (-0.18, 0.18)]
    stack = box((0.9, 0.6, top_m - low_m), (x, y, 0.5 * (low_m + top_m)), texture["wall"], 3.0)
    return merged([stack, *pots])
