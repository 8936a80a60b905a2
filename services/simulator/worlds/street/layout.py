# SPDX-License-Identifier: Apache-2.0
"""The street that never moves: ground, houses, plants, lamps and signs along a road, in the world frame."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.painting.buildings import facades
from services.simulator.painting.library import ROOFS, SIGN_COUNT
from services.simulator.shapes.buildings import houses
from services.simulator.shapes.meshes import Mesh, merged, quads, surface
from services.simulator.shapes.things import greenery
from services.simulator.worlds.street.road import (
    AHEAD_M,
    BEHIND_M,
    CROSS_HALF_WIDTH_M,
    KERB_HEIGHT_M,
    KERB_M,
    LANE_EDGE_M,
    PAVEMENT_EDGE_M,
    Road,
)

_CORNER_M = CROSS_HALF_WIDTH_M + 1.6
_CROSS_LENGTH_M = 110.0
_MARK_HEIGHT_M = 0.006


def street_mesh(road: Road, seed: int, texture: Mapping[str, int]) -> Mesh:
    """Everything that stands, parked cars apart, as one mesh."""
    rng = np.random.default_rng([seed, 3])
    first, last = -BEHIND_M, road.length_m + AHEAD_M
    pieces = [_ground(road, first, last, texture), _horizon(road, texture)]
    pieces += _markings(road, rng, first, last, texture)
    for side in (-1.0, 1.0):
        pieces += _row_of_houses(road, rng, side, (first, last), texture)
        pieces += _street_furniture(road, rng, side, (first, last), texture)
    return merged(pieces)


def _strip(
    road: Road,
    s: NDArray[np.float64],
    edges: list[tuple[float, float]],
    texture: int,
    *,
    tile_m: float,
    tint: float = 1.0,
) -> Mesh:
    """One part along the road through (n, z) `edges`, textured in metres along and across."""
    n, z = (np.array(values) for values in zip(*edges, strict=True))
    plane = road.point(s[:, None], n[None, :])
    points = np.concatenate([plane, np.broadcast_to(z, plane.shape[:2])[..., None]], axis=-1)
    across = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(n), np.diff(z)))]) + n[0]
    uv = np.stack(np.broadcast_arrays(s[:, None] / tile_m, across[None, :] / tile_m), axis=-1)
    return surface(points, uv, texture, (tint, tint, tint))


def _stretches(road: Road, first: float, last: float, gap_m: float) -> list[NDArray[np.float64]]:
    """Sample positions of the stretches between junctions."""
    cuts = [first, *(s for j in road.junctions_m for s in (j - gap_m, j + gap_m)), last]
    return [
        np.linspace(a, b, max(2, int((b - a) / 2.0) + 1)) for a, b in zip(cuts[::2], cuts[1::2], strict=True) if b > a
    ]


def _ground(road: Road, first: float, last: float, texture: Mapping[str, int]) -> Mesh:
    along = np.linspace(first, last, int((last - first) / 2.0) + 1)
    pieces = [_strip(road, along, [(-KERB_M, 0.0), (0.0, 0.0), (KERB_M, 0.0)], texture["asphalt"], tile_m=10.24)]
    top = KERB_HEIGHT_M
    for s in _stretches(road, first, last, _CORNER_M):
        for side in (-1.0, 1.0):
            kerb = [(side * KERB_M, -0.02), (side * KERB_M, top), (side * (KERB_M + 0.18), top)]
            pavement = [(side * (KERB_M + 0.18), top), (side * PAVEMENT_EDGE_M, top)]
            garden = [(side * PAVEMENT_EDGE_M, top), (side * 20.0, top), (side * 48.0, top)]
            pieces.append(_strip(road, s, kerb, texture["paving"], tile_m=4.0, tint=1.12))
            pieces.append(_strip(road, s, pavement, texture["paving"], tile_m=4.0, tint=0.92))
            pieces.append(_strip(road, s, garden, texture["grass"], tile_m=5.0))
    for junction in road.junctions_m:
        for side in (-1.0, 1.0):
            pieces += _cross_street(road, junction, side, texture)
    return merged(pieces)


def _cross_street(road: Road, s: float, side: float, texture: Mapping[str, int]) -> list[Mesh]:
    """One arm of the street that crosses at `s`; the road is straight there."""

    def plane(low: float, high: float, z: float, name: str, tile_m: float) -> Mesh:
        n = np.linspace(KERB_M, _CROSS_LENGTH_M, 12)
        points = road.point(s + np.array([[low], [high]]), side * n[None, :])
        points = np.concatenate([points, np.full((*points.shape[:2], 1), z)], axis=-1)
        uv = np.stack(np.broadcast_arrays(n[None, :] / tile_m, np.array([[low], [high]]) / tile_m), axis=-1)
        return surface(points, uv, texture[name], (1.0, 1.0, 1.0))

    half = CROSS_HALF_WIDTH_M
    return [
        plane(-half, half, 0.0, "asphalt", 10.24),
        plane(-_CORNER_M, -half, KERB_HEIGHT_M, "paving", 4.0),
        plane(half, _CORNER_M, KERB_HEIGHT_M, "paving", 4.0),
    ]


def _decal(road: Road, at: tuple[float, float], size: tuple[float, float], texture: int, layer: int = 1) -> Mesh:
    """Flat thing on the road at (s, n), `size` metres along and across."""
    s, n = at
    half_s, half_n = 0.5 * size[0], 0.5 * size[1]
    plane = road.point(s + half_s * np.array([-1, 1, 1, -1]), n + half_n * np.array([1, 1, -1, -1]))
    corners = np.column_stack([plane, np.full(4, layer * _MARK_HEIGHT_M)])
    return quads([corners], [[0, 0], [1, 0], [1, 1], [0, 1]], texture)


def _markings(
    road: Road, rng: np.random.Generator, first: float, last: float, texture: Mapping[str, int]
) -> list[Mesh]:
    """Centre dashes, bay corners, stop lines and zebra crossings; mended patches and covers below them."""
    pieces = []
    paint = texture["worn_paint"]
    for s in np.arange(first, last, 6.0):
        if not road.near_junction(s, 8.0):
            pieces.append(_decal(road, (s, 0.0), (3.0, 0.14), paint, 2))
        for side in (-1.0, 1.0):
            if not road.near_junction(s, 11.0):
                middle = 0.5 * (LANE_EDGE_M + KERB_M)
                pieces.append(_decal(road, (s + 3.0, side * middle), (0.12, KERB_M - LANE_EDGE_M), paint, 2))
                pieces.append(_decal(road, (s + 3.0, side * LANE_EDGE_M), (1.2, 0.12), paint, 2))
    for junction in road.junctions_m:
        for n in np.arange(-KERB_M + 0.7, KERB_M - 0.5, 1.1):
            pieces.append(_decal(road, (junction - 7.6, float(n)), (3.2, 0.55), paint, 2))
        pieces.append(_decal(road, (junction - 10.2, -0.5 * LANE_EDGE_M), (0.4, LANE_EDGE_M), paint, 2))
        pieces.append(_decal(road, (junction + 6.4, 0.5 * LANE_EDGE_M), (0.4, LANE_EDGE_M), paint, 2))
    for _ in range(int((last - first) / 5.0)):
        size = (float(rng.uniform(0.6, 3.5)), float(rng.uniform(0.5, 2.2)))
        s, n = float(rng.uniform(first, last)), float(rng.uniform(-4.0, 4.0))
        pieces.append(_decal(road, (s, n), size, texture["patch"]))
    for _ in range(int((last - first) / 14.0)):
        s, n = float(rng.uniform(first, last)), float(rng.uniform(-3.0, 3.0))
        pieces.append(_decal(road, (s, n), (0.75, 0.75), texture["manhole"], 3))
    return pieces


def _row_of_houses(
    road: Road, rng: np.random.Generator, side: float, reach: tuple[float, float], texture: Mapping[str, int]
) -> list[Mesh]:
    """Houses with gardens along one side, a wood behind them; fronts look at the road."""
    first, last = reach
    pieces = []
    s = first + float(rng.uniform(2.0, 8.0))
    turn = np.pi if side > 0 else 0.0
    while s < last:
        style = facades.STYLES[int(rng.integers(0, len(facades.STYLES)))]
        width = facades.BAY_M * int(rng.integers(3, 6))
        middle = s + 0.5 * width
        s += width + float(rng.choice([0.8, 3.5, 7.0]))
        if road.near_junction(middle, _CORNER_M + 0.5 * width + 0.5):
            continue
        setback = float(rng.uniform(2.4, 6.5))
        tone = rng.uniform(0.88, 1.1, 3) * rng.uniform(0.85, 1.05)
        house = houses.house_mesh(
            style,
            (width, float(rng.uniform(8.0, 11.0))),
            ROOFS[int(rng.integers(0, len(ROOFS)))],
            texture,
            first_bay=int(rng.integers(0, 4)),
            tint=(float(tone[0]), float(tone[1]), float(tone[2])),
        )
        pieces.append(house.transformed(road.pose(middle, side * (PAVEMENT_EDGE_M + setback), turn, KERB_HEIGHT_M)))
        if setback > 3.4 and rng.random() < 0.7:
            fence = houses.fence_mesh(int(rng.integers(0, 3)), width * float(rng.uniform(0.55, 0.95)), texture)
            pieces.append(fence.transformed(road.pose(middle, side * (PAVEMENT_EDGE_M + 0.45), turn, KERB_HEIGHT_M)))
        if setback > 4.0:
            at = middle + float(rng.uniform(-0.4, 0.4)) * width
            bush = greenery.bush_mesh(rng, texture)
            pieces.append(bush.transformed(road.pose(at, side * (PAVEMENT_EDGE_M + 1.7), 0.0, KERB_HEIGHT_M)))
    for s in np.arange(first, last, 11.0):
        at, n = float(s + rng.uniform(-4, 4)), side * float(rng.uniform(27.0, 40.0))
        if not road.near_junction(at, 9.0):
            big = np.diag([1.5, 1.5, 1.5, 1.0])
            pieces.append(greenery.tree_mesh(rng, texture).transformed(road.pose(at, n) @ big))
    return pieces


def _street_furniture(
    road: Road, rng: np.random.Generator, side: float, reach: tuple[float, float], texture: Mapping[str, int]
) -> list[Mesh]:
    """Trees and lamps along the kerb, signs, bins."""
    first, last = reach
    pieces = []
    turn = np.pi if side > 0 else 0.0
    kerb = KERB_M + 0.75
    lamp, waste = greenery.lamp_mesh(texture), greenery.bin_mesh(texture)
    for k, s in enumerate(np.arange(first + (4.0 if side > 0 else 9.0), last, 13.0)):
        at = float(s + rng.uniform(-2.0, 2.0))
        if road.near_junction(at, 10.0):
            continue
        if k % 3 == 2:
            thing = lamp
        elif rng.random() < 0.75:
            thing = greenery.tree_mesh(rng, texture)
        else:
            thing = greenery.sign_mesh(int(rng.integers(0, SIGN_COUNT)), texture)
        yaw = turn if k % 3 == 2 else (0.0 if side < 0 else np.pi)
        pieces.append(thing.transformed(road.pose(at, side * kerb, yaw, KERB_HEIGHT_M)))
        if rng.random() < 0.35:
            place = road.pose(at + 1.6, side * (PAVEMENT_EDGE_M - 0.45), float(rng.uniform(-0.3, 0.3)), KERB_HEIGHT_M)
            pieces.append(waste.transformed(place))
    return pieces


def _horizon(road: Road, texture: Mapping[str, int]) -> Mesh:
    """Fields to the horizon and a ring of woods round them."""
    centre = road.point(0.5 * road.length_m, 0.0)
    radius = 0.6 * road.length_m + 420.0
    angle = np.linspace(0.0, 2.0 * np.pi, 65)
    ring = centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    low, high = (np.column_stack([ring, np.full(65, z)]) for z in (-2.0, 34.0))
    uv = np.zeros((2, 65, 2))
    uv[:, :, 0] = angle * 4.0 / (2.0 * np.pi)
    uv[0, :, 1], uv[1, :, 1] = 0.99, 0.01
    wood = surface(np.stack([low, high]), uv, texture["tree_line"])
    half = radius * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    corners = np.column_stack([centre + half, np.full(4, -0.12)])
    fields = quads([corners], (half - half[0]) / 9.0, texture["grass"], (0.95, 1.0, 1.0))
    return merged([wood, fields])
