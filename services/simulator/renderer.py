# SPDX-License-Identifier: Apache-2.0
"""One view of the street: rays, nearest surfaces, colours, smoothed edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera import PinholeCamera
from services.simulator.raycast import RayScene
from services.simulator.shading import Shader, ViewTriangles
from services.simulator.textures import TextureAtlas
from services.simulator.triangles import TriangleTable, joined

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

_EDGE_OFFSETS_PX = ((-0.125, -0.375), (0.375, -0.125), (-0.375, 0.125), (0.125, 0.375))
_EDGE_COLUMNS = 64
"""Pixels on edges are shaded in rows of this many: cv2.remap takes no longer side than 32767."""


@dataclass(frozen=True, slots=True)
class Hits:
    """Nearest surfaces. depth_m: along the optical axis, infinity = sky; triangle: row in the table, -1 = sky."""

    depth_m: Floats32
    triangle: NDArray[np.int32]


@dataclass(frozen=True, slots=True)
class RenderedView:
    """image: BGR uint8 (H, W, 3). hits: (H, W). table: the triangles that `hits` counts."""

    image: NDArray[np.uint8]
    hits: Hits
    table: TriangleTable


class StaticScene:
    """What never moves: its triangles and the tree to cast rays against, built once."""

    def __init__(self, table: TriangleTable, threads: int) -> None:
        self.table = table
        self.rays = scene_of(table, threads)
        self.threads = threads


def scene_of(table: TriangleTable, threads: int) -> RayScene:
    """Scene whose triangles are the table's rows."""
    return RayScene(table.corner.reshape(-1, 3), np.arange(3 * len(table), dtype=np.int32).reshape(-1, 3), threads)


class Renderer:
    """Renders a static scene and, in front of it, the triangles of the moment."""

    def __init__(self, camera: PinholeCamera, static: StaticScene, atlas: TextureAtlas) -> None:
        self._camera, self._static = camera, static
        self._shader = Shader(atlas, atlas.index["clouds"])
        self._columns, self._rows = camera.pixel_grid()

    def cast(self, world_from_camera: Floats, moving: TriangleTable | None) -> tuple[Hits, list[RayScene]]:
        """Nearest surfaces of every pixel, and the scenes they were found in."""
        scenes = [self._static.rays]
        if moving is not None and len(moving):
            scenes.append(scene_of(moving, self._static.threads))
        x, y = self._camera.normalised(self._columns, self._rows)
        return self._nearest(scenes, world_from_camera, x, y), scenes

    def render(self, world_from_camera: Floats, moving: TriangleTable | None) -> RenderedView:
        """Image and surfaces seen from a pose; the image is the same whatever was rendered before."""
        hits, scenes = self.cast(world_from_camera, moving)
        static = self._static.table
        table = static if moving is None else joined(static, moving)
        x, y = self._camera.normalised(self._columns, self._rows)
        edges = np.nonzero(_edges(table.part, hits.triangle))
        edge_samples = []
        for offset in _EDGE_OFFSETS_PX:
            columns, rows = (_in_rows(grid[edges]) for grid in (self._columns, self._rows))
            place = self._camera.normalised(columns + np.float32(offset[0]), rows + np.float32(offset[1]))
            edge_samples.append((self._nearest(scenes, world_from_camera, *place), *place))
        view, row_of = self._view(table, [hits, *(s[0] for s in edge_samples)], world_from_camera)
        colour = self._shader.shade(view, row_of[hits.triangle], hits.depth_m, x, y)
        if len(edges[0]):
            mixed = sum(
                self._shader.shade(view, row_of[h.triangle], h.depth_m, ex, ey) for h, ex, ey in edge_samples
            ) / np.float32(len(edge_samples))
            colour[edges] = mixed.reshape(-1, 3)[: len(edges[0])]
        image = np.clip(colour + np.float32(0.5), 0.0, 255.0).astype(np.uint8)
        return RenderedView(image, hits, table)

    def _nearest(self, scenes: Sequence[RayScene], world_from_camera: Floats, x: Floats32, y: Floats32) -> Hits:
        axes = world_from_camera[:3, :3].astype(np.float32)
        flat = np.stack([x.ravel(), y.ravel(), np.ones(x.size, np.float32)], axis=1)
        directions = flat @ axes.T
        depth, triangle = scenes[0].cast(world_from_camera[:3, 3], directions)
        for scene in scenes[1:]:
            other_depth, other_triangle = scene.cast(world_from_camera[:3, 3], directions)
            nearer = other_depth < depth
            depth = np.where(nearer, other_depth, depth)
            triangle = np.where(nearer, other_triangle + len(self._static.table), triangle)
        return Hits(depth.reshape(x.shape), triangle.reshape(x.shape))

    def _view(
        self, table: TriangleTable, hits: list[Hits], world_from_camera: Floats
    ) -> tuple[ViewTriangles, NDArray[np.int32]]:
        """Coefficients of the triangles seen, and the row of each triangle among them (last entry: sky)."""
        seen = np.zeros(len(table) + 1, bool)
        for hit in hits:
            seen[hit.triangle] = True
        seen[-1] = False
        rows = np.flatnonzero(seen)
        row_of = np.full(len(table) + 1, -1, np.int32)
        row_of[rows] = np.arange(len(rows), dtype=np.int32)
        return self._shader.view(table.take(rows), world_from_camera, self._camera.fx_px), row_of


def _edges(part: NDArray[np.int32], triangle: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Pixels with a neighbour of another part."""
    parts = np.append(part, -1)[triangle]
    edge = np.zeros(parts.shape, bool)
    across, down = parts[:, 1:] != parts[:, :-1], parts[1:] != parts[:-1]
    edge[:, 1:] |= across
    edge[:, :-1] |= across
    edge[1:] |= down
    edge[:-1] |= down
    return edge


def _in_rows(values: Floats32) -> Floats32:
    """A list as rows of `_EDGE_COLUMNS`, the last one filled up."""
    missing = -len(values) % _EDGE_COLUMNS
    return np.pad(values, (0, missing), mode="edge" if len(values) else "constant").reshape(-1, _EDGE_COLUMNS)
