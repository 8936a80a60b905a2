# SPDX-License-Identifier: Apache-2.0
"""One view of a world: nearest surfaces, colours, smoothed edges, shadows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.camera import Camera
from services.simulator.rendering.bands import Bands
from services.simulator.rendering.contact import ContactShade, Footprint
from services.simulator.rendering.nearest import Hits, Sight, Surfaces
from services.simulator.rendering.shading import Pixels, Shader, ViewTriangles
from services.simulator.rendering.shadow import SunShadow, softened
from services.simulator.rendering.triangles import TriangleTable, joined

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

_EDGE_OFFSETS_PX = ((-0.34, -0.2), (0.34, 0.2))
"""Where a pixel on an edge is looked at again, beside its centre."""
_EDGE_COLUMNS = 128
"""Pixels on edges are shaded in rows of this many: cv2.remap takes no longer side than 32767."""


@dataclass(frozen=True, slots=True)
class RenderedView:
    """image: BGR uint8 (H, W, 3). hits, instance: (H, W); instance 0 is nobody."""

    image: NDArray[np.uint8]
    hits: Hits
    instance: NDArray[np.int32]


class Renderer:
    """Renders static surfaces and, among them, those of the moment; triangles count on from the static ones."""

    def __init__(self, camera: Camera, static: Surfaces, shader: Shader, bands: Bands, shadows: bool) -> None:
        self._camera, self._static = camera, static
        self._shader, self._bands = shader, bands
        self._shadows = shadows and shader.light.casts_shadows
        self._x, self._y = camera.normalised()
        self._contact = ContactShade(camera, shader.light.contact_shade)

    def sight(self, world_from_camera: Floats, moving: Surfaces | None) -> Sight:
        """What a pose sees."""
        return Sight(self._camera, world_from_camera, self._static, moving)

    def render(self, sight: Sight, footprints: Sequence[Footprint]) -> RenderedView:
        """Image and surfaces of what a pose sees; the ground is darker round `footprints`."""
        world_from_camera, moving, hits = sight.world_from_camera, sight.moving, sight.hits
        tables = [self._static.table] + ([moving.table] if moving else [])
        edge = np.nonzero(_edges(_per_triangle([table.part for table in tables], renumber=True), hits.triangle))
        beside = self._look_again(sight, edge)
        view, row_of = self._view(world_from_camera, tables, [hits.triangle, beside.triangle])
        pixels = Pixels(hits.triangle, hits.depth_m, self._x, self._y, self._camera.pixel_extent)
        pixels, beside = (replace(p, triangle=row_of[p.triangle]) for p in (pixels, beside))
        if self._shadows:
            shadow = SunShadow(self._shader.light.direction_to_sun, [self._static] + ([moving] if moving else []))
            sunny = view.sunny[pixels.triangle]
            lit = shadow.lit(world_from_camera, pixels.x, pixels.y, pixels.depth_m, sunny)
            pixels = replace(pixels, lit=softened(lit, sunny))
            lit = shadow.lit(world_from_camera, beside.x, beside.y, beside.depth_m, view.sunny[beside.triangle])
            beside = replace(beside, lit=lit)
        colour = self._shaded(view, pixels)
        if len(edge[0]):
            more = self._shaded(view, beside).reshape(-1, 3)
            samples = more[: len(edge[0]) * len(_EDGE_OFFSETS_PX)].reshape(len(_EDGE_OFFSETS_PX), -1, 3)
            colour[edge] = (colour[edge] + samples.sum(axis=0)) / np.float32(len(_EDGE_OFFSETS_PX) + 1)
        instance = np.append(_per_triangle([table.instance for table in tables]), 0)[hits.triangle]
        on_ground = (instance == 0) & (hits.triangle >= 0)
        self._contact.darken(colour, hits.depth_m, on_ground, world_from_camera, footprints)
        colour += np.float32(0.5)
        image = np.clip(colour, 0.0, 255.0, out=colour).astype(np.uint8)
        return RenderedView(image, hits, instance)

    def _look_again(self, sight: Sight, edge: tuple[NDArray[np.intp], ...]) -> Pixels:
        """What is seen beside the centres of some pixels, in rows, the last one filled up."""
        grids = [self._camera.normalised(offset) for offset in _EDGE_OFFSETS_PX]
        x, y = (_in_rows(np.concatenate([grid[axis][edge] for grid in grids])) for axis in range(2))
        within = tuple(_in_rows(np.tile(places, len(_EDGE_OFFSETS_PX))) for places in edge)
        hits = sight.nearest(x, y, within)
        extent = self._camera.pixel_extent
        return Pixels(hits.triangle, hits.depth_m, x, y, extent if extent.ndim == 0 else extent[within])

    def _view(
        self, world_from_camera: Floats, tables: list[TriangleTable], triangles: list[NDArray[np.int32]]
    ) -> tuple[ViewTriangles, NDArray[np.int32]]:
        """Coefficients of the triangles seen, and each triangle's row among them; the last of both is the sky."""
        split = len(tables[0])
        total = sum(len(table) for table in tables)
        seen = np.zeros(total + 1, bool)
        for triangle in triangles:
            seen[triangle] = True
        seen[-1] = False
        rows = np.flatnonzero(seen)
        row_of = np.full(total + 1, len(rows), np.int32)
        row_of[rows] = np.arange(len(rows), dtype=np.int32)
        table = tables[0].take(rows[rows < split])
        if len(tables) > 1:
            table = joined([table, tables[1].take(rows[rows >= split] - split)])
        return self._shader.view(table, world_from_camera), row_of

    def _shaded(self, view: ViewTriangles, pixels: Pixels) -> Floats32:
        """Colours, (N, M, 3), worked out band by band."""
        colour = np.empty((*pixels.x.shape, 3), np.float32)

        def shade(band: slice) -> None:
            colour[band] = self._shader.shade(view, pixels.rows(band))

        self._bands.run(shade, *pixels.x.shape)
        return colour


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


def _in_rows(values: NDArray[Any]) -> NDArray[Any]:
    """A list as rows of `_EDGE_COLUMNS`, the last one filled up."""
    missing = -len(values) % _EDGE_COLUMNS
    return np.pad(values, (0, missing), mode="edge" if len(values) else "constant").reshape(-1, _EDGE_COLUMNS)
