# SPDX-License-Identifier: Apache-2.0
"""Surfaces and painted marks that lie on the hills. World frame, metres."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.meshes import WHITE, Mesh, Tint, quads, surface
from services.simulator.worlds.town.ground import Hills
from services.simulator.worlds.town.plan import Line

Floats = NDArray[np.float64]

MARK_LIFT_M = 0.008
"""How far each layer of paint lies above the one below: more than the mesh of the ground misses the hills by."""
_MARK_STEP_M = 2.0


class Drape:
    """Lays things on the hills. step_m: how far samples along a street may be apart."""

    def __init__(self, hills: Hills, step_m: float) -> None:
        self.hills, self.step_m = hills, step_m

    def lifted(self, xy: Floats, lift: Floats | float) -> Floats:
        """World points (..., 3) at `lift` above the hills."""
        return np.concatenate([xy, (self.hills.height_m(xy) + lift)[..., None]], axis=-1)

    def samples(self, first_m: float, last_m: float) -> Floats:
        """Positions along a line, evenly spaced, both ends among them."""
        count = max(1, int(np.ceil((last_m - first_m) / self.step_m)))
        return np.linspace(first_m, last_m, count + 1, dtype=np.float64)

    def strip(
        self,
        line: Line,
        s: Floats,
        edges: Sequence[tuple[float, float]],
        texture: int,
        *,
        tile_m: float,
        tint: Tint = WHITE,
    ) -> Mesh:
        """Along a line through (n, lift) `edges`; the texture goes along and across, in tiles of `tile_m`."""
        n, lift = (np.array(values) for values in zip(*edges, strict=True))
        points = self.lifted(line.point(s[:, None], n[None, :]), lift)
        across = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(n), np.diff(lift)))]) + n[0]
        uv = np.stack(np.broadcast_arrays(s[:, None] / tile_m, across[None, :] / tile_m), axis=-1)
        return surface(points, uv, texture, tint)

    def sheet(self, xy: Floats, lift: Floats | float, texture: int, *, tile_m: float, tint: Tint = WHITE) -> Mesh:
        """Over a grid of places (R, C, 2); the texture lies as the world does, so that sheets continue each other."""
        return surface(self.lifted(xy, lift), xy / tile_m, texture, tint)

    def marks(
        self,
        line: Line,
        at: Floats,
        size_m: tuple[float, float],
        texture: int,
        *,
        layer: int = 2,
        tint: Tint = WHITE,
        base_m: float = 0.0,
    ) -> Mesh:
        """Flat rectangles of one size, along and across the line, at (s, n) places (M, 2); whole texture on each.

        A negative size turns the texture round along that side.
        """
        at = np.asarray(at, np.float64).reshape(-1, 2)
        rows = max(1, int(np.ceil(abs(size_m[0]) / _MARK_STEP_M)))
        columns = max(1, int(np.ceil(abs(size_m[1]) / _MARK_STEP_M)))
        u, v = np.linspace(0.0, 1.0, rows + 1), np.linspace(0.0, 1.0, columns + 1)
        s = at[:, 0, None, None] + (u[None, :, None] - 0.5) * size_m[0]
        n = at[:, 1, None, None] + (v[None, None, :] - 0.5) * size_m[1]
        points = self.lifted(line.point(s, n), base_m + layer * MARK_LIFT_M)
        uv = np.broadcast_to(np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1), (len(at), rows + 1, columns + 1, 2))
        return quads(_cells(points), _cells(uv), texture, tint, one_part=True)


def _cells(grid: Floats) -> Floats:
    """Corners (Q, 4, K) of the cells of grids (M, R, C, K)."""
    stacked = np.stack([grid[:, :-1, :-1], grid[:, :-1, 1:], grid[:, 1:, 1:], grid[:, 1:, :-1]], axis=3)
    return stacked.reshape(-1, 4, grid.shape[-1])
