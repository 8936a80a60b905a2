# SPDX-License-Identifier: Apache-2.0
"""Which ground is taken: streets and pavements first, then house by house, so that nothing stands in anything else."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.worlds.town.carriageways import DistanceMap
from services.simulator.worlds.town.ground import Hills
from services.simulator.worlds.town.plan import Line
from services.simulator.worlds.town.profile import (
    KERB_HEIGHT_M,
    KERB_M,
    PAVEMENT_EDGE_M,
    SIDE_KERB_M,
    SIDE_PAVEMENT_EDGE_M,
)

Floats = NDArray[np.float64]


class Site:
    """Taken ground in a grid, and where upright things stand on the hills."""

    def __init__(self, distances: DistanceMap, hills: Hills) -> None:
        self.hills = hills
        self._origin, self._cell_m = distances.origin, distances.cell_m
        on_loop = distances.loop_m < PAVEMENT_EDGE_M - KERB_M
        on_side = distances.side_m < SIDE_PAVEMENT_EDGE_M - SIDE_KERB_M
        self._taken = (on_loop | on_side).astype(np.uint8)

    def take(self, pose: Floats, size_m: tuple[float, float], *, slack_m: float = 0.0, centre_y_m: float = 0.0) -> bool:
        """Take a rectangle of the object frame (x, y) round (0, centre_y_m), if it is free but for `slack_m` in width.

        Returns whether it was.
        """
        inner = self._filled(pose, (size_m[0] - slack_m, size_m[1]), centre_y_m)
        if inner is None:
            return False
        window, mask = inner
        if (self._taken[window] & mask).any():
            return False
        whole = self._filled(pose, size_m, centre_y_m)
        if whole is not None:
            self._taken[whole[0]] |= whole[1]
        return True

    def is_free(self, pose: Floats, size_m: tuple[float, float], centre_y_m: float = 0.0) -> bool:
        """Whether a rectangle is free, without taking it."""
        found = self._filled(pose, size_m, centre_y_m)
        return found is not None and not (self._taken[found[0]] & found[1]).any()

    def _filled(
        self, pose: Floats, size_m: tuple[float, float], centre_y_m: float
    ) -> tuple[tuple[slice, slice], NDArray[np.uint8]] | None:
        """Window of the grid and the rectangle in it; None where it reaches beyond the grid."""
        half = 0.5 * np.array(size_m)
        corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * half + [0.0, centre_y_m]
        cells = (corners @ pose[:2, :2].T + pose[:2, 3] - self._origin) / self._cell_m
        low, high = np.floor(cells.min(axis=0)).astype(int), np.ceil(cells.max(axis=0)).astype(int) + 1
        if low.min() < 0 or high[1] > self._taken.shape[0] or high[0] > self._taken.shape[1]:
            return None
        mask = np.zeros((high[1] - low[1], high[0] - low[0]), np.uint8)
        cv2.fillConvexPoly(mask, np.rint((cells - low) * 16.0).astype(np.int32), 1, cv2.LINE_8, 4)
        return np.s_[low[1] : high[1], low[0] : high[0]], mask

    def pose(self, line: Line, s: float, n: float, yaw: float = 0.0, lift_m: float = KERB_HEIGHT_M) -> Floats:
        """world_from_object, 4x4, upright at (s, n) of a line, `lift_m` above the hills, turned against the line."""
        return self.pose_at(line.point(s, n), float(line.heading(s)) + yaw, lift_m)

    def pose_at(self, xy: Floats, heading: float, lift_m: float = KERB_HEIGHT_M) -> Floats:
        """world_from_object, 4x4, upright at a world place."""
        cos, sin = np.cos(heading), np.sin(heading)
        matrix = np.eye(4)
        matrix[:2, :2] = [[cos, -sin], [sin, cos]]
        matrix[:2, 3] = xy
        matrix[2, 3] = float(self.hills.height_m(np.asarray(xy, np.float64))) + lift_m
        return matrix
