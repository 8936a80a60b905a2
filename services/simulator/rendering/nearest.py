# SPDX-License-Identifier: Apache-2.0
"""Which surface each pixel shows."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.camera import Camera
from services.simulator.rendering.bounds import BOX_CORNERS, windows
from services.simulator.rendering.raycast import RayScene
from services.simulator.rendering.triangles import TriangleTable

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Hits:
    """Nearest surfaces. depth_m: along the optical axis, infinity = sky; triangle: row in the table, -1 = sky."""

    depth_m: Floats32
    triangle: NDArray[np.int32]


class Surfaces:
    """Triangles and the tree to cast rays against."""

    def __init__(self, table: TriangleTable, threads: int) -> None:
        self.table = table
        corners = np.arange(3 * len(table), dtype=np.int32).reshape(-1, 3)
        self.rays = RayScene(table.corner.reshape(-1, 3), corners, threads)


class Sight:
    """What one pose sees of the static surfaces and, among them, of the moment's; triangles count on from the static.

    moving: those of the moment, None where there are none.
    """

    def __init__(self, camera: Camera, world_from_camera: Floats, static: Surfaces, moving: Surfaces | None) -> None:
        self._camera, self._static = camera, static
        self.world_from_camera, self.moving = world_from_camera, moving
        shape = camera.height, camera.width
        self._covered = _covered(camera, world_from_camera, moving.table) if moving else np.zeros(shape, bool)

    @cached_property
    def hits(self) -> Hits:
        """Surfaces of all pixels."""
        return self.nearest(*self._camera.normalised())

    def nearest(self, x: Floats32, y: Floats32, within: tuple[NDArray[np.intp], ...] | None = None) -> Hits:
        """Surfaces in the directions x / z and y / z, both (N, M): those of all pixels, or of pixels `within`."""
        axes = self.world_from_camera[:3, :3].astype(np.float32)
        directions = np.empty((x.size, 3), np.float32)
        for k in range(3):
            directions[:, k] = (axes[k, 0] * x + axes[k, 1] * y + axes[k, 2]).ravel()
        origin = self.world_from_camera[:3, 3]
        depth, triangle = self._static.rays.cast(origin, directions)
        if self.moving is not None:
            near = np.flatnonzero(self._covered if within is None else self._covered[within])
            nearer_depth, nearer = self.moving.rays.cast(origin, directions[near])
            closer = nearer_depth < depth[near]
            depth[near[closer]] = nearer_depth[closer]
            triangle[near[closer]] = nearer[closer] + len(self._static.table)
        return Hits(depth.reshape(x.shape), triangle.reshape(x.shape))


def _covered(camera: Camera, world_from_camera: Floats, table: TriangleTable) -> NDArray[np.bool_]:
    """Pixels that an instance of the table may cover, (H, W), by the images of boxes round them."""
    first = np.flatnonzero(np.diff(table.instance, prepend=-1))
    low = np.minimum.reduceat(table.corner.min(axis=1), first)
    high = np.maximum.reduceat(table.corner.max(axis=1), first)
    corner = np.where(BOX_CORNERS[None], high[:, None], low[:, None])
    covered = np.zeros((camera.height, camera.width), bool)
    for window in windows(camera, (corner - world_from_camera[:3, 3]) @ world_from_camera[:3, :3]):
        if window is not None:
            covered[window] = True
    return covered
