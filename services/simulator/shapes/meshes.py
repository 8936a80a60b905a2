# SPDX-License-Identifier: Apache-2.0
"""Textured triangle meshes and the shapes everything in the street is put together from.

Every shape is made of quads given by four corners in order round the face. Winding does not matter: the renderer turns
each normal towards the camera.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

Tint = tuple[float, float, float]
WHITE: Tint = (1.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True)
class Mesh:
    """Triangles with one texture, tint and part each.

    vertices: (V, 3) float64, metres, in the frame of the object. triangles: (T, 3) int32.
    uv: (T, 3, 2) float64, in tiles of the texture, v downwards. texture: (T,) int32, index in the library.
    tint: (T, 3) float32, factors of blue, green, red. part: (T,) int32; pixels of one part need no anti-aliasing
    against each other.
    """

    vertices: NDArray[np.float64]
    triangles: NDArray[np.int32]
    uv: NDArray[np.float64]
    texture: NDArray[np.int32]
    tint: NDArray[np.float32]
    part: NDArray[np.int32]

    def transformed(self, target_from_source: NDArray[np.float64]) -> Mesh:
        """The same mesh in another frame (4x4)."""
        moved = self.vertices @ target_from_source[:3, :3].T + target_from_source[:3, 3]
        return replace(self, vertices=moved)

    def tinted(self, tint: Tint) -> Mesh:
        """The same mesh with every tint multiplied."""
        return replace(self, tint=self.tint * np.asarray(tint, np.float32))


def merged(meshes: Sequence[Mesh]) -> Mesh:
    """One mesh of several; parts stay distinct."""
    first_vertex = np.cumsum([0] + [len(m.vertices) for m in meshes])
    first_part = np.cumsum([0] + [int(m.part.max(initial=-1)) + 1 for m in meshes])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.triangles + o for m, o in zip(meshes, first_vertex, strict=False)]).astype(np.int32),
        np.concatenate([m.uv for m in meshes]),
        np.concatenate([m.texture for m in meshes]),
        np.concatenate([m.tint for m in meshes]),
        np.concatenate([m.part + o for m, o in zip(meshes, first_part, strict=False)]).astype(np.int32),
    )


def cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cross products of rows, (N, 3); several times as fast as numpy's on the few rows of one shape."""
    return np.asarray(a[:, [1, 2, 0]] * b[:, [2, 0, 1]] - a[:, [2, 0, 1]] * b[:, [1, 2, 0]])


def quads(corners: ArrayLike, uv: ArrayLike, texture: int, tint: Tint = WHITE, one_part: bool = False) -> Mesh:
    """Mesh of quads. corners: (Q, 4, 3); uv: (Q, 4, 2) or (4, 2) for all. Triangles without area are left out."""
    points = np.asarray(corners, np.float64).reshape(-1, 4, 3)
    count = len(points)
    coordinates = np.broadcast_to(np.asarray(uv, np.float64), (count, 4, 2))
    corner = np.array([[0, 1, 2], [0, 2, 3]])
    triangles = (4 * np.arange(count)[:, None, None] + corner).reshape(-1, 3)
    uv_of_triangle = coordinates[:, corner].reshape(-1, 3, 2)
    part = np.zeros(2 * count) if one_part else np.repeat(np.arange(count), 2)
    vertices = points.reshape(-1, 3)
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    keep = np.abs(cross(b - a, c - a)).max(axis=1) > 1e-9
    total = int(keep.sum())
    return Mesh(
        vertices,
        triangles[keep].astype(np.int32),
        uv_of_triangle[keep],
        np.full(total, texture, np.int32),
        np.tile(np.asarray(tint, np.float32), (total, 1)),
        part[keep].astype(np.int32),
    )


def stretch(u: float = 1.0, v: float = 1.0) -> NDArray[np.float64]:
    """Texture coordinates of a quad that shows `u` tiles across and `v` tiles down, (4, 2)."""
    return np.array([[0.0, 0.0], [u, 0.0], [u, v], [0.0, v]])


def box(size: Sequence[float], centre: Sequence[float], texture: int, tile_m: float = 1.0, tint: Tint = WHITE) -> Mesh:
    """Axis-aligned box of `size` (x, y, z) metres whose texture repeats every `tile_m` metres."""
    hx, hy, hz = (0.5 * float(v) for v in size)
    corners, coordinates = [], []
    for normal, u_axis, v_axis in ((0, 1, 2), (1, 0, 2), (2, 0, 1)):
        half = (hx, hy, hz)
        for sign in (-1.0, 1.0):
            face = np.zeros((4, 3))
            face[:, normal] = sign * half[normal]
            face[:, u_axis] = np.array([-1, 1, 1, -1]) * half[u_axis]
            face[:, v_axis] = np.array([1, 1, -1, -1]) * half[v_axis]
            width, height = 2.0 * half[u_axis] / tile_m, 2.0 * half[v_axis] / tile_m
            corners.append(face + np.asarray(centre, np.float64))
            coordinates.append(np.array([[0, 0], [width, 0], [width, height], [0, height]]))
    return quads(np.array(corners), np.array(coordinates), texture, tint)


def tube(
    start: ArrayLike,
    end: ArrayLike,
    radii: tuple[float, float],
    texture: int,
    sides: int = 8,
    *,
    repeat: tuple[float, float] = (1.0, 1.0),
    tint: Tint = WHITE,
    caps: bool = True,
) -> Mesh:
    """Tapered tube from `start` to `end`; the texture goes `repeat` times round and along it."""
    first, last = np.asarray(start, np.float64), np.asarray(end, np.float64)
    axis = (last - first) / np.linalg.norm(last - first)
    helper = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    across = np.cross(axis, helper)
    across /= np.linalg.norm(across)
    other = np.cross(axis, across)
    angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    ring = np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * other
    low, high = first + radii[0] * ring, last + radii[1] * ring
    corners = np.stack([high[:-1], high[1:], low[1:], low[:-1]], axis=1)
    u = np.arange(sides + 1) / sides * repeat[0]
    coordinates = np.zeros((sides, 4, 2))
    coordinates[:, 0, 0] = coordinates[:, 3, 0] = u[:-1]
    coordinates[:, 1, 0] = coordinates[:, 2, 0] = u[1:]
    coordinates[:, 2:, 1] = repeat[1]
    pieces = [quads(corners, coordinates, texture, tint, one_part=True)]
    if caps:
        pieces += [disc(low, first, texture, tint), disc(high, last, texture, tint)]
    return merged(pieces)


def disc(ring: NDArray[np.float64], centre: NDArray[np.float64], texture: int, tint: Tint = WHITE) -> Mesh:
    """Fan from `centre` to a closed ring (N + 1, 3), mapped onto the circle inscribed in the texture."""
    sides = len(ring) - 1
    angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)
    rim = 0.5 + 0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    corners = np.stack([np.broadcast_to(centre, (sides, 3)), ring[:-1], ring[1:], ring[1:]], axis=1)
    middle = np.full((sides, 2), 0.5)
    return quads(corners, np.stack([middle, rim[:-1], rim[1:], rim[1:]], axis=1), texture, tint, one_part=True)


def blob(
    centre: Sequence[float],
    radii: Sequence[float],
    texture: int,
    rng: np.random.Generator | None = None,
    *,
    sides: int = 8,
    repeat: tuple[float, float] = (2.0, 1.0),
    tint: Tint = WHITE,
) -> Mesh:
    """Ellipsoid of `radii` (x, y, z), dented at random by up to a fifth when a generator is given."""
    rings = max(4, sides // 2 + 1)
    polar = np.linspace(0.0, np.pi, rings + 1)[:, None]
    around = np.linspace(0.0, 2.0 * np.pi, sides + 1)[None, :]
    scale = np.ones((rings + 1, sides + 1))
    if rng is not None:
        scale += rng.uniform(-0.2, 0.2, scale.shape)
        scale[:, -1] = scale[:, 0]
    points = np.stack(
        [np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar) + 0.0 * around], axis=-1
    ) * scale[..., None] * np.asarray(radii, np.float64) + np.asarray(centre, np.float64)
    points[0], points[-1] = points[0].mean(axis=0), points[-1].mean(axis=0)
    grid = np.stack(np.broadcast_arrays(around / (2.0 * np.pi) * repeat[0], polar / np.pi * repeat[1]), axis=-1)
    return surface(points, grid, texture, tint)


def surface(points: NDArray[np.float64], uv: NDArray[np.float64], texture: int, tint: Tint = WHITE) -> Mesh:
    """One part from a grid of points (R, C, 3) with texture coordinates (R, C, 2)."""

    def cells(grid: NDArray[np.float64]) -> NDArray[np.float64]:
        stacked = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=2)
        return stacked.reshape(-1, 4, grid.shape[-1])

    return quads(cells(points), cells(uv), texture, tint, one_part=True)
