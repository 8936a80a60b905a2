# SPDX-License-Identifier: Apache-2.0
"""How far any place is from the nearest carriageway, looked up in a grid."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.line import SampledLine
from services.simulator.worlds.town.profile import (
    CORNER_RADIUS_M,
    KERB_M,
    PAVEMENT_EDGE_M,
    SIDE_KERB_M,
    SIDE_PAVEMENT_EDGE_M,
)

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

REACH_M = 12.0
"""Distances are exact up to here and cut off beyond."""
_CELL_M = 0.5
_SEGMENT_M = 1.0


class DistanceMap:
    """Signed distance to the kerb, negative on the carriageway, metres; kerbs are rounded where side streets open.

    loop_m, side_m: grids (rows along y) of the distance to the kerbs of the loop and of side streets, each without
    the other. origin: world (x, y) of cell [0, 0].
    """

    def __init__(
        self, low: Floats, high: Floats, loop: SampledLine, sides: Iterable[tuple[SampledLine, float]]
    ) -> None:
        self.origin = np.floor(np.asarray(low, np.float64)) - 2.0 * REACH_M
        shape = np.ceil((np.asarray(high) + 2.0 * REACH_M - self.origin) / _CELL_M).astype(int)[::-1] + 1
        self.cell_m = _CELL_M
        self.loop_m = self._distances(shape, [(loop, loop.length_m)], KERB_M)
        self.side_m = self._distances(shape, sides, SIDE_KERB_M)
        # Union of both with corners rounded by the radius.
        r = np.float32(CORNER_RADIUS_M)
        nearest = np.minimum(self.loop_m, self.side_m)
        rounded = r - np.hypot(np.maximum(r - self.loop_m, 0.0), np.maximum(r - self.side_m, 0.0))
        self._kerb_m = np.where(nearest < r, rounded, nearest)

    def _distances(
        self, shape: NDArray[np.int_], lines: Iterable[tuple[SampledLine, float]], kerb_m: float
    ) -> Floats32:
        grid = np.full(tuple(shape), REACH_M, np.float32)
        half = round((kerb_m + REACH_M + _SEGMENT_M) / _CELL_M) + 1
        for line, length_m in lines:
            points = line.point(np.linspace(0.0, length_m, round(length_m / _SEGMENT_M) + 1), 0.0) - self.origin
            for start, end in pairwise(points):
                column, row = np.rint(start / _CELL_M).astype(int)
                rows = slice(max(row - half, 0), row + half + 1)
                columns = slice(max(column - half, 0), column + half + 1)
                window = grid[rows, columns]
                x = np.arange(columns.start, columns.start + window.shape[1]) * _CELL_M - start[0]
                y = np.arange(rows.start, rows.start + window.shape[0]) * _CELL_M - start[1]
                step = (end - start) / np.linalg.norm(end - start)
                along = np.clip(x * step[0] + y[:, None] * step[1], 0.0, np.linalg.norm(end - start))
                away = np.hypot(x - along * step[0], y[:, None] - along * step[1]) - kerb_m
                np.minimum(window, away.astype(np.float32), out=window)
        return grid

    def outside_m(self, xy: Floats) -> Floats:
        """Signed distance to the kerb at world positions (..., 2), shape (...)."""
        return self._at(self._kerb_m, xy)

    def behind_pavement_m(self, xy: Floats) -> Floats:
        """Signed distance to the back edge of the pavements at world positions (..., 2), shape (...)."""
        loop_m = self._at(self.loop_m, xy) - (PAVEMENT_EDGE_M - KERB_M)
        return np.asarray(np.minimum(loop_m, self._at(self.side_m, xy) - (SIDE_PAVEMENT_EDGE_M - SIDE_KERB_M)))

    def _at(self, grid: Floats32, xy: Floats) -> Floats:
        """Between the four nearest cells; beyond the edge the value there."""
        at = np.minimum(np.maximum((xy - self.origin) / _CELL_M, 0.0), np.array(grid.shape[::-1], np.float64) - 1.001)
        cell = at.astype(np.intp)
        fx, fy = at[..., 0] - cell[..., 0], at[..., 1] - cell[..., 1]
        column, row = cell[..., 0], cell[..., 1]
        low = grid[row, column] * (1.0 - fx) + grid[row, column + 1] * fx
        high = grid[row + 1, column] * (1.0 - fx) + grid[row + 1, column + 1] * fx
        return np.asarray(low * (1.0 - fy) + high * fy)
