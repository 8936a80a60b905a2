# SPDX-License-Identifier: Apache-2.0
"""Colour of hit points: texture, sun, haze, and the sky where nothing is hit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.rendering.textures import Lookup, TextureAtlas
from services.simulator.rendering.triangles import TriangleTable

Floats = NDArray[np.float64]
Floats32 = NDArray[np.float32]

_TO_SUN = np.array([0.42, 0.36, 0.83]) / np.linalg.norm([0.42, 0.36, 0.83])
_SUN, _SKY_LIGHT, _GROUND_LIGHT = 0.62, 0.50, 0.40
_HAZE_COLOUR = np.array([226.0, 214.0, 204.0], np.float32)
_HAZE_LENGTH_M = 700.0
_FOOTPRINT = 0.85
"""Share of a pixel's extent that a texture is filtered over; the rest is left to the lens."""


class Shader:
    """Shades pixels of one view; `sky_texture` covers the upper half of the sphere of directions."""

    def __init__(self, atlas: TextureAtlas, sky_texture: int) -> None:
        self._atlas = atlas
        self._sky = sky_texture

    def shade(
        self, view: ViewTriangles, triangle: NDArray[np.int32], depth_m: Floats32, x: Floats32, y: Floats32
    ) -> Floats32:
        """Colours BGR 0 to 255, (N, M, 3).

        triangle: row in the view's table, its length = sky; depth_m: along the optical axis; x, y: normalised image
        coordinates; all (N, M).
        """
        column = np.take(view.columns, triangle, axis=1)
        sky = triangle == view.columns.shape[1] - 1
        t = np.where(sky, np.float32(1.0), depth_m)
        ju = column[0] * x + column[1] * y + column[2]
        jv = column[3] * x + column[4] * y + column[5]
        slant = t / (column[6] * x + column[7] * y + column[8])
        u = column[9] + t * ju
        v = column[10] + t * jv
        du = _extent(t * column[0:2], ju * slant * column[6:8])
        dv = _extent(t * column[3:5], jv * slant * column[6:8])
        if sky.any():
            u[sky], v[sky] = view.sky_position(x[sky], y[sky])
            du[sky] = dv[sky] = 0.5 * view.pixel
        scale = np.float32(view.pixel * _FOOTPRINT)
        lookup = Lookup(column[11], column[12], column[13], column[14], u, v, du * scale, dv * scale)
        colour = self._atlas.sample(lookup)
        colour *= np.moveaxis(column[15:18], 0, -1)
        clear = np.exp(t * np.float32(-1.0 / _HAZE_LENGTH_M))[..., None]
        colour -= _HAZE_COLOUR
        colour *= np.where(sky[..., None], np.float32(1.0), clear)
        colour += _HAZE_COLOUR
        return colour

    def view(self, table: TriangleTable, world_from_camera: Floats, fx_px: float) -> ViewTriangles:
        """What this view's pixels need of the triangles in `table`."""
        return ViewTriangles(table, self._atlas, self._sky, world_from_camera, fx_px)


class ViewTriangles:
    """Per triangle the coefficients that give texture position, footprint and light from (x, y, depth).

    A pixel's ray is D = X x + Y y + Z in the world frame (camera axes X, Y, Z), its hit O + t D, so u and v are linear
    in t D, and the footprint follows from the plane: dP/dx = t (X - D (n.X) / (n.D)).
    """

    def __init__(
        self, table: TriangleTable, atlas: TextureAtlas, sky_texture: int, world_from_camera: Floats, fx_px: float
    ) -> None:
        self.pixel = np.float32(1.0 / fx_px)
        self._axes = world_from_camera[:3, :3].astype(np.float32)
        axes, origin = world_from_camera[:3, :3], world_from_camera[:3, 3]
        to_camera = origin - table.corner[:, 0]
        base = table.uv + np.einsum("tij,tj->ti", table.gradient, to_camera)
        gradient = table.gradient @ axes
        normal = table.normal @ axes
        light = _light(table, to_camera)
        count = len(table)
        self.columns = np.zeros((18, count + 1), np.float32)
        self.columns[0:3, :count] = gradient[:, 0].T
        self.columns[3:6, :count] = gradient[:, 1].T
        self.columns[6:9, :count] = normal.T
        # Whole tiles are dropped while still in double precision.
        self.columns[9:11, :count] = (base - np.floor(base)).T
        texture = np.append(table.texture, sky_texture)
        self.columns[11:13] = atlas.log2_size[texture].T
        self.columns[13:15] = atlas.origin_px[texture].T
        self.columns[15:18, :count] = light.T
        self.columns[8, count] = self.columns[15:18, count] = 1.0

    def sky_position(self, x: Floats32, y: Floats32) -> tuple[Floats32, Floats32]:
        """Position in the sky's texture of image directions: azimuth, and elevation from the horizon up."""
        direction = self._axes @ np.stack([x, y, np.ones_like(x)])
        azimuth = np.arctan2(direction[1], direction[0]) * np.float32(1.0 / np.pi)
        rise = np.arctan2(direction[2], np.hypot(direction[0], direction[1])) * np.float32(2.0 / np.pi)
        return azimuth, np.clip(1.0 - 2.2 * rise, 0.01, 0.99).astype(np.float32)


def _extent(by_axes: Floats32, by_slant: Floats32) -> Floats32:
    """Extent of one texture coordinate over a unit of x and of y together; arguments (2, ...), one row an axis."""
    across = by_axes - by_slant
    np.square(across, out=across)
    return np.asarray(np.sqrt(across[0] + across[1]))


def _light(table: TriangleTable, to_camera: Floats) -> Floats:
    """Tint times light of each triangle, its normal turned to the camera."""
    facing = np.sign(np.einsum("ij,ij->i", table.normal, to_camera))
    normal = table.normal * np.where(facing == 0.0, 1.0, facing)[:, None]
    sun = np.maximum(normal @ _TO_SUN, 0.0)
    sky = 0.5 + 0.5 * normal[:, 2]
    return np.asarray(table.tint * (_SUN * sun + _SKY_LIGHT * sky + _GROUND_LIGHT * (1.0 - sky))[:, None])
