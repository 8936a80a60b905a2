# SPDX-License-Identifier: Apache-2.0
"""Colour of hit points: texture, sun, haze, and the sky where nothing is hit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.rendering.light import Light
from services.simulator.rendering.sky import Sky
from services.simulator.rendering.textures import Lookup, TextureAtlas
from services.simulator.rendering.triangles import TriangleTable

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

_FOOTPRINT = 0.85
"""Share of a pixel's extent that a texture is filtered over; the rest is left to the lens."""

_WITHOUT_SHADOWS = 18
"""Columns of a view's triangles that are needed where all of the sun's light arrives."""


@dataclass(frozen=True, slots=True)
class Pixels:
    """What is seen in some pixels, all (N, M).

    triangle: row in the view's table, its length (or -1) = sky. depth_m: along the optical axis. x, y: directions x / z
    and y / z; extent: their change from pixel to pixel, or () for all. lit: share of the sun that arrives; None: all.
    """

    triangle: NDArray[np.int32]
    depth_m: Floats32
    x: Floats32
    y: Floats32
    extent: Floats32
    lit: Floats32 | None = None

    def rows(self, band: slice) -> Pixels:
        """Some rows of it."""
        extent = self.extent if self.extent.ndim == 0 else self.extent[band]
        lit = None if self.lit is None else self.lit[band]
        return Pixels(self.triangle[band], self.depth_m[band], self.x[band], self.y[band], extent, lit)


class Shader:
    """Shades pixels of one view; `sky_texture` covers the upper half of the sphere of directions."""

    def __init__(self, atlas: TextureAtlas, sky_texture: int, light: Light) -> None:
        self._atlas = atlas
        self._sky_texture = sky_texture
        self.light = light
        self._sky = Sky(light)
        self._haze = np.array(light.haze, np.float32)
        self._haze_rate = np.float32(-1.0 / light.haze_length_m)

    def shade(self, view: ViewTriangles, pixels: Pixels) -> Floats32:
        """Colours BGR 0 to 255, (N, M, 3)."""
        x, y, triangle = pixels.x, pixels.y, pixels.triangle
        column = np.take(view.columns if pixels.lit is not None else view.columns[:_WITHOUT_SHADOWS], triangle, axis=1)
        sky = triangle == view.columns.shape[1] - 1
        t = np.where(sky, np.float32(1.0), pixels.depth_m)
        ju = column[0] * x + column[1] * y + column[2]
        jv = column[3] * x + column[4] * y + column[5]
        slant = t / (column[6] * x + column[7] * y + column[8])
        u = column[9] + t * ju
        v = column[10] + t * jv
        du = _extent(t * column[0:2], ju * slant * column[6:8])
        dv = _extent(t * column[3:5], jv * slant * column[6:8])
        any_sky = bool(sky.any())
        if any_sky:
            u[sky], v[sky] = self._sky.position(view.axes, x[sky], y[sky])
            du[sky] = dv[sky] = 0.5 * pixels.extent if pixels.extent.ndim == 0 else 0.5 * pixels.extent[sky]
        scale = pixels.extent * np.float32(_FOOTPRINT)
        lookup = Lookup(column[11], column[12], column[13], column[14], u, v, du * scale, dv * scale)
        colour = self._atlas.sample(lookup)
        light = column[15:18]
        if pixels.lit is not None:
            light = light - column[18:21] * (np.float32(1.0) - pixels.lit)
        colour *= np.moveaxis(light, 0, -1)
        clear = np.exp(t * self._haze_rate)[..., None]
        colour -= self._haze
        colour *= np.where(sky[..., None], np.float32(1.0), clear)
        colour += self._haze
        if any_sky and not self._sky.plain:
            colour[sky] = self._sky.lit(colour[sky], view.axes, x[sky], y[sky])
        return colour

    def view(self, table: TriangleTable, world_from_camera: Floats) -> ViewTriangles:
        """What this view's pixels need of the triangles in `table`."""
        return ViewTriangles(table, self._atlas, self._sky_texture, self.light, world_from_camera)


class ViewTriangles:
    """Per triangle the coefficients that give texture position, footprint and light from (x, y, depth).

    A pixel's ray is D = X x + Y y + Z in the world frame (camera axes X, Y, Z), its hit O + t D, so u and v are linear
    in t D, and the footprint follows from the plane: dP/dx = t (X - D (n.X) / (n.D)). sunny: whether the sun's light
    would fall on it; the last row is the sky's.
    """

    def __init__(
        self, table: TriangleTable, atlas: TextureAtlas, sky_texture: int, light: Light, world_from_camera: Floats
    ) -> None:
        self.axes = world_from_camera[:3, :3].astype(np.float32)
        axes, origin = world_from_camera[:3, :3], world_from_camera[:3, 3]
        to_camera = origin - table.corner[:, 0]
        base = table.uv + np.einsum("tij,tj->ti", table.gradient, to_camera)
        gradient = table.gradient @ axes
        normal = table.normal @ axes
        whole, sun = _light(table, to_camera, light)
        count = len(table)
        self.columns = np.zeros((21, count + 1), np.float32)
        self.columns[0:3, :count] = gradient[:, 0].T
        self.columns[3:6, :count] = gradient[:, 1].T
        self.columns[6:9, :count] = normal.T
        # Whole tiles are dropped while still in double precision.
        self.columns[9:11, :count] = (base - np.floor(base)).T
        texture = np.append(table.texture, sky_texture)
        self.columns[11:13] = atlas.log2_size[texture].T
        self.columns[13:15] = atlas.origin_px[texture].T
        self.columns[15:18, :count] = whole.T
        self.columns[18:21, :count] = sun.T
        self.columns[8, count] = self.columns[15:18, count] = 1.0
        self.sunny: NDArray[np.bool_] = np.any(self.columns[18:21], axis=0)


def _extent(by_axes: Floats32, by_slant: Floats32) -> Floats32:
    """Extent of one texture coordinate over a unit of x and of y together; arguments (2, ...), one row an axis."""
    across = by_axes - by_slant
    np.square(across, out=across)
    return np.asarray(np.sqrt(across[0] + across[1]))


def _light(table: TriangleTable, to_camera: Floats, light: Light) -> tuple[Floats, Floats]:
    """Tint times light of each triangle, its normal turned to the camera: all of it, and the sun's part; (T, 3)."""
    facing = np.sign(np.einsum("ij,ij->i", table.normal, to_camera))
    normal = table.normal * np.where(facing == 0.0, 1.0, facing)[:, None]
    sun = np.maximum(normal @ light.direction_to_sun, 0.0)[:, None] * np.array(light.sun)
    sky = (0.5 + 0.5 * normal[:, 2])[:, None]
    whole = sun + np.array(light.sky) * sky + np.array(light.ground) * (1.0 - sky)
    return np.asarray(table.tint * whole), np.asarray(table.tint * sun)
