# SPDX-License-Identifier: Apache-2.0
"""One view of the street: rays, nearest surfaces, colours, smoothed edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.pinhole import PinholeCamera
from services.simulator.rendering.contact import ContactShade, Footprint
from services.simulator.rendering.raycast import RayScene
from services.simulator.rendering.shading import Shader, ViewTriangles
from services.simulator.rendering.textures import TextureAtlas
from services.simulator.rendering.triangles import TriangleTable, joined

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

_EDGE_OFFSETS_PX = ((-0.34, -0.2), (0.34, 0.2))
"""Where a pixel on an edge is looked at again, beside its centre."""
_BOX_CORNERS = np.array([[bool(k & bit) for bit in (1, 2, 4)] for k in range(8)])
_EDGE_COLUMNS = 128
"""Pixels on edges are shaded in rows of this many: cv2.remap takes no longer side than 32767."""
_BAND_PX = 16384
"""Pixels shaded at a time, so that intermediate results stay in the processor's cache."""


@dataclass(frozen=True, slots=True)
class Hits:
    """Nearest surfaces. depth_m: along the optical axis, infinity = sky; triangle: row in the table, -1 = sky."""

    depth_m: Floats32
    triangle: NDArray[np.int32]


@dataclass(frozen=True, slots=True)
class RenderedView:
    """image: BGR uint8 (H, W, 3). hits, instance: (H, W); instance 0 is nobody."""

    image: NDArray[np.uint8]
    hits: Hits
    instance: NDArray[np.int32]


class Surfaces:
    """Triangles and the tree to cast rays against."""

    def __init__(self, table: TriangleTable, threads: int) -> None:
        self.table = table
        corners = np.arange(3 * len(table), dtype=np.int32).reshape(-1, 3)
        self.rays = RayScene(table.corner.reshape(-1, 3), corners, threads)


class Renderer:
    """Renders static surfaces and, among them, those of the moment; triangles count on from the static ones."""

    def __init__(self, camera: PinholeCamera, static: Surfaces, atlas: TextureAtlas, sky_texture: str) -> None:
        self._camera, self._static = camera, static
        self._shader = Shader(atlas, atlas.index[sky_texture])
        self._columns, self._rows = camera.pixel_grid()
        self._x, self._y = camera.normalised(self._columns, self._rows)
        self._contact = ContactShade(camera)

    def cast(self, world_from_camera: Floats, moving: Surfaces | None) -> Hits:
        """Nearest surfaces of every pixel."""
        return self._nearest(world_from_camera, moving, self._columns, self._rows)

    def render(
        self, world_from_camera: Floats, moving: Surfaces | None, footprints: Sequence[Footprint]
    ) -> RenderedView:
        """Image and surfaces seen from a pose; the ground is darker round `footprints`."""
        hits = self.cast(world_from_camera, moving)
        tables = [self._static.table] + ([moving.table] if moving else [])
        edge = np.nonzero(_edges(_per_triangle([table.part for table in tables], renumber=True), hits.triangle))
        again = self._look_again(world_from_camera, moving, edge)
        view, row_of = self._view(world_from_camera, tables, [hits, again[0]])
        colour = self._shaded(view, row_of, hits, self._x, self._y)
        if len(edge[0]):
            beside = self._shaded(view, row_of, *again).reshape(-1, 3)[: len(edge[0]) * len(_EDGE_OFFSETS_PX)]
            total = colour[edge] + beside.reshape(len(_EDGE_OFFSETS_PX), -1, 3).sum(axis=0)
            colour[edge] = total / np.float32(len(_EDGE_OFFSETS_PX) + 1)
        instance = np.append(_per_triangle([table.instance for table in tables]), 0)[hits.triangle]
        on_ground = (instance == 0) & (hits.triangle >= 0)
        self._contact.darken(colour, hits.depth_m, on_ground, world_from_camera, footprints)
        image = np.clip(colour + np.float32(0.5), 0.0, 255.0).astype(np.uint8)
        return RenderedView(image, hits, instance)

    def _look_again(
        self, world_from_camera: Floats, moving: Surfaces | None, edge: tuple[NDArray[np.intp], ...]
    ) -> tuple[Hits, Floats32, Floats32]:
        """Surfaces beside the centres of some pixels, in rows, and their normalised image coordinates."""
        columns, rows = (
            _in_rows(np.concatenate([grid[edge] + np.float32(offset[axis]) for offset in _EDGE_OFFSETS_PX]))
            for axis, grid in enumerate((self._columns, self._rows))
        )
        return self._nearest(world_from_camera, moving, columns, rows), *self._camera.normalised(columns, rows)

    def _nearest(self, world_from_camera: Floats, moving: Surfaces | None, columns: Floats32, rows: Floats32) -> Hits:
        x, y = (grid.ravel() for grid in self._camera.normalised(columns, rows))
        axes = world_from_camera[:3, :3].astype(np.float32)
        directions = np.empty((x.size, 3), np.float32)
        for k in range(3):
            directions[:, k] = axes[k, 0] * x + axes[k, 1] * y + axes[k, 2]
        origin = world_from_camera[:3, 3]
        depth, triangle = self._static.rays.cast(origin, directions)
        if moving is not None:
            covered = self._may_cover(moving.table, world_from_camera)
            near = np.flatnonzero(covered[np.rint(rows).astype(np.intp), np.rint(columns).astype(np.intp)])
            nearer_depth, nearer = moving.rays.cast(origin, directions[near])
            closer = nearer_depth < depth[near]
            depth[near[closer]] = nearer_depth[closer]
            triangle[near[closer]] = nearer[closer] + len(self._static.table)
        return Hits(depth.reshape(columns.shape), triangle.reshape(columns.shape))

    def _may_cover(self, table: TriangleTable, world_from_camera: Floats) -> NDArray[np.bool_]:
        """Pixels that an instance of the table may cover, (H, W), by the images of boxes round them."""
        first = np.flatnonzero(np.diff(table.instance, prepend=-1))
        low = np.minimum.reduceat(table.corner.min(axis=1), first)
        high = np.maximum.reduceat(table.corner.max(axis=1), first)
        corner = np.where(_BOX_CORNERS[None], high[:, None], low[:, None])
        points = (corner - world_from_camera[:3, 3]) @ world_from_camera[:3, :3]
        place = self._camera.project(points)
        close = points[..., 2].min(axis=1) < 0.2
        covered = np.zeros(self._columns.shape, bool)
        for box, whole_image in zip(place, close, strict=True):
            if whole_image:
                covered[:] = True
                break
            left, top = np.maximum(np.floor(box.min(axis=0)) - 1.0, 0.0).astype(int)
            right, bottom = np.maximum(np.ceil(box.max(axis=0)) + 2.0, 0.0).astype(int)
            covered[top:bottom, left:right] = True
        return covered

    def _view(
        self, world_from_camera: Floats, tables: list[TriangleTable], hits: list[Hits]
    ) -> tuple[ViewTriangles, NDArray[np.int32]]:
        """Coefficients of the triangles seen, and each triangle's row among them; the last of both is the sky."""
        split = len(tables[0])
        total = sum(len(table) for table in tables)
        seen = np.zeros(total + 1, bool)
        for hit in hits:
            seen[hit.triangle] = True
        seen[-1] = False
        rows = np.flatnonzero(seen)
        row_of = np.full(total + 1, len(rows), np.int32)
        row_of[rows] = np.arange(len(rows), dtype=np.int32)
        table = tables[0].take(rows[rows < split])
        if len(tables) > 1:
            table = joined([table, tables[1].take(rows[rows >= split] - split)])
        return self._shader.view(table, world_from_camera, self._camera.fx_px), row_of

    def _shaded(self, view: ViewTriangles, row_of: NDArray[np.int32], hits: Hits, x: Floats32, y: Floats32) -> Floats32:
        """Colours, (N, M, 3), worked out band by band."""
        height = max(1, _BAND_PX // x.shape[1])
        bands = [np.s_[row : row + height] for row in range(0, len(x), height)]
        shaded = [self._shader.shade(view, row_of[hits.triangle[b]], hits.depth_m[b], x[b], y[b]) for b in bands]
        return np.concatenate(shaded) if shaded else np.zeros((*x.shape, 3), np.float32)


def _per_triangle(columns: list[NDArray[np.int32]], renumber: bool = False) -> NDArray[np.int32]:
    """One column of both tables; `renumber` keeps the second one's numbers apart from the first one's."""
    if len(columns) == 1:
        return columns[0]
    return np.concatenate([columns[0], columns[1] + (int(columns[0].max()) + 1 if renumber else 0)])


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
