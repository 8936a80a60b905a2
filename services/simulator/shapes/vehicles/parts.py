# SPDX-License-Identifier: Apache-2.0
"""Parts that the town's vehicles are put together from. Object frame: x forward, y left, z up; metres."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.meshes import WHITE, Mesh, Tint, disc, merged, quads, surface

Floats = NDArray[np.float64]

UNIT = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
_SIDES = 10


def wheels(
    axles_m: Sequence[float], half_width_m: float, radius_m: float, texture: Mapping[str, int], thick_m: float = 0.22
) -> Mesh:
    """A wheel at both ends of every axle, its outside at the half width."""
    angle = np.linspace(0.0, 2.0 * np.pi, _SIDES + 1)
    ring = radius_m * np.column_stack([np.cos(angle), np.zeros_like(angle), np.sin(angle)])
    pieces = []
    for x in axles_m:
        for side in (-1.0, 1.0):
            rim = ring + np.array([x, side * half_width_m, radius_m])
            inner = rim - np.array([0.0, side * thick_m, 0.0])
            u = np.arange(_SIDES + 1) * 0.6
            uv = np.stack(np.broadcast_arrays(u[None, :], np.array([[0.0], [0.1]])), axis=-1)
            pieces.append(surface(np.stack([inner, rim]), uv, texture["rubber"]))
            pieces.append(disc(rim, np.array([x, side * half_width_m, radius_m]), texture["wheel"]))
    return merged(pieces)


def upright(
    x_m: float, across: tuple[float, float], up: tuple[float, float], texture: int, *, tint: Tint = WHITE
) -> Mesh:
    """A picture that faces forward or back at x; across: y of its left and right edge, up: z of its lower and upper."""
    corners = [
        [x_m, across[0], up[1]],
        [x_m, across[1], up[1]],
        [x_m, across[1], up[0]],
        [x_m, across[0], up[0]],
    ]
    return quads([corners], UNIT, texture, tint)


def body(
    outline: Sequence[tuple[float, float]],
    half_width_m: float,
    sides: tuple[int, int],
    skins: Sequence[tuple[int, Tint]],
    *,
    tint: Tint = WHITE,
    lean: float = 0.04,
) -> Mesh:
    """A body from its side outline (x, z) from rear bottom over the roof to front bottom.

    sides: textures of the left and the right side, each a picture of the whole side with the front to its right seen
    from the right; skins: texture and tint of each piece of the outline; pieces whose texture is a picture show it
    upright. lean: share by which the roof is narrower.
    """
    points = np.array(outline)
    x, z = points.T
    top, bottom = z.max(), z.min()
    width = half_width_m * (1.0 - lean * np.clip((z - 0.55 * top) / (0.45 * top), 0.0, 1.0))
    left, right = np.column_stack([x, width, z]), np.column_stack([x, -width, z])
    u = (x - x.min()) / (x.max() - x.min())
    v = (top - z) / (top - bottom)
    pieces = []
    for side, (rim, texture) in enumerate(zip((left, right), sides, strict=True)):
        across = 1.0 - u if side == 0 else u
        middle = np.array([0.5 * (x.min() + x.max()), rim[0, 1], 0.5 * (top + bottom)])
        ring, uv = np.concatenate([rim, rim[:1]]), np.column_stack([across, v])
        uv_ring = np.concatenate([uv, uv[:1]])
        count = len(rim)
        corners = np.stack([np.broadcast_to(middle, (count, 3)), ring[:-1], ring[1:], ring[1:]], axis=1)
        at = np.stack([np.broadcast_to([0.5, 0.5], (count, 2)), uv_ring[:-1], uv_ring[1:], uv_ring[1:]], axis=1)
        pieces.append(quads(corners, at, texture, tint, one_part=True))
    for k, (texture, colour) in enumerate(skins):
        corners = np.stack([left[k + 1], right[k + 1], right[k], left[k]])
        pieces.append(quads(corners if z[k + 1] >= z[k] else corners[[2, 3, 0, 1]], UNIT, texture, colour))
    pieces.append(quads(np.stack([left[-1], right[-1], right[0], left[0]]), UNIT, skins[0][0], (0.2, 0.2, 0.2)))
    return merged(pieces)
