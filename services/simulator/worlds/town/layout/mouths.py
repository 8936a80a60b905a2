# SPDX-License-Identifier: Apache-2.0
"""Where side streets open into the loop: the corners of kerb, pavement and lawn between the two."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.meshes import Mesh, merged, surface
from services.simulator.worlds.line import SampledLine
from services.simulator.worlds.town.carriageways import DistanceMap
from services.simulator.worlds.town.layout.drape import Drape
from services.simulator.worlds.town.profile import (
    CORNER_RADIUS_M,
    KERB_HEIGHT_M,
    KERB_M,
    PAVEMENT_EDGE_M,
    SIDE_KERB_M,
    SIDE_PAVEMENT_EDGE_M,
)
from services.simulator.worlds.town.side_streets import Mouth

Floats = NDArray[np.float64]

KERB_TOP_M = 0.18
"""Width of the kerb stone."""
_ARC = 8
_LAWN_M = 8.0
_UNDER_M = 0.4
"""How far lawns reach below pavements, so that no gap opens."""
_PAVEMENT_M, _SIDE_PAVEMENT_M = PAVEMENT_EDGE_M - KERB_M, SIDE_PAVEMENT_EDGE_M - SIDE_KERB_M


class MouthShape:
    """Geometry of one mouth. arm: the side street's centre line away from this mouth, straight at first.

    Corners are described by (a, b): metres outwards from the loop's kerb and along it from the side street's kerb.
    """

    def __init__(self, loop: SampledLine, mouth: Mouth, arm: SampledLine) -> None:
        self._loop, self._mouth, self._arm = loop, mouth, arm
        self._s = mouth.s_m + np.linspace(-24.0, 24.0, 193)
        kerb = loop.point(self._s, mouth.side * KERB_M)
        heading = float(arm.heading(0.0))
        out, left = np.array([np.cos(heading), np.sin(heading)]), np.array([-np.sin(heading), np.cos(heading)])
        away = kerb - arm.point(0.0, 0.0)
        order = np.argsort(away @ left)
        self._lateral, self._outwards, self._along = (away @ left)[order], (away @ out)[order], self._s[order]

    def kerb_at(self, lateral_m: Floats | float) -> Floats:
        """How far out the loop's kerb is, by the offset to the left of the arm."""
        return np.asarray(np.interp(lateral_m, self._lateral, self._outwards))

    def gap(self) -> tuple[float, float]:
        """The part of the loop's s without kerb and pavement on this side."""
        reach = SIDE_KERB_M + CORNER_RADIUS_M
        ends = np.interp([-reach, reach], self._lateral, self._along)
        return float(ends.min()), float(ends.max())

    def arm_begin(self, hand: float) -> float:
        """Where along the arm its own kerb and pavement begin, on its left (+1) or right (-1)."""
        return float(self.kerb_at(hand * SIDE_KERB_M)) + CORNER_RADIUS_M

    def _place(self, a: Floats, b: Floats, hand: float) -> Floats:
        """World (x, y) of corner coordinates: square to the arm beside it, square to the loop where that goes on."""
        lateral = hand * (SIDE_KERB_M + b)
        # Where the arm's own kerb begins, all its edges begin at the same distance.
        square = np.clip(a / CORNER_RADIUS_M, 0.0, 1.0)
        kerb = (1.0 - square) * self.kerb_at(lateral) + square * self.kerb_at(hand * SIDE_KERB_M)
        by_arm = self._arm.point(kerb + a, lateral)
        s = np.interp(lateral, self._lateral, self._along)
        by_loop = self._loop.point(s, self._mouth.side * (KERB_M + a))
        give = np.clip((a - _PAVEMENT_M) / (CORNER_RADIUS_M - _PAVEMENT_M), 0.0, 1.0)
        weight = np.clip(b / CORNER_RADIUS_M, 0.0, 1.0) * (1.0 - give)
        return np.asarray(by_arm + weight[..., None] * (by_loop - by_arm))

    def _rim(self, distances: DistanceMap, hand: float, inside_m: float) -> Floats:
        """World (x, y) of the rounded kerb, (_ARC + 1, 2), `inside_m` behind its edge, from the loop to the arm."""
        angle = np.linspace(0.0, 0.5 * np.pi, _ARC + 1)
        direction = np.stack([-np.cos(angle), -np.sin(angle)], axis=1)
        r = CORNER_RADIUS_M
        near, far = np.zeros(_ARC + 1), np.full(_ARC + 1, 1.5 * r)
        for _ in range(24):
            middle = 0.5 * (near + far)
            ab = r + middle[:, None] * direction
            inside = distances.outside_m(self._place(ab[:, 0], ab[:, 1], hand)) > inside_m
            near, far = np.where(inside, middle, near), np.where(inside, far, middle)
        ab = r + near[:, None] * direction
        # Both ends lie where the straight kerbs begin.
        ab[0], ab[-1] = (inside_m, r), (r, inside_m)
        return self._place(ab[:, 0], ab[:, 1], hand)

    def mesh(self, drape: Drape, distances: DistanceMap, texture: Mapping[str, int]) -> Mesh:
        """Asphalt, kerb, pavement and lawn of both corners."""
        pieces = []
        top, r = KERB_HEIGHT_M, CORNER_RADIUS_M
        for hand in (-1.0, 1.0):
            rim, inner = self._rim(distances, hand, 0.0), self._rim(distances, hand, KERB_TOP_M)
            corner = np.broadcast_to(self._place(np.array(-0.3), np.array(-0.3), hand), rim.shape)
            t = np.linspace(0.0, 1.0, 4)[:, None, None]
            fan = corner + t * (rim - corner)
            pieces.append(drape.sheet(fan, -0.002, texture["asphalt"], tile_m=10.24))
            kerb = [drape.lifted(rim, -0.03), drape.lifted(rim, top), drape.lifted(inner, top)]
            way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(rim, axis=0), axis=1))])
            uv = np.stack(np.broadcast_arrays(np.array([0.0, 0.15, 0.33])[:, None], way[None, :]), axis=-1) / 4.0
            pieces.append(surface(np.stack(kerb), uv, texture["paving"], (1.12, 1.12, 1.12)))
            half = _ARC // 2
            a = np.concatenate([np.full(half, _PAVEMENT_M), np.linspace(_PAVEMENT_M, r, half + 1)])
            b = np.concatenate([np.linspace(r, _SIDE_PAVEMENT_M, half + 1), np.full(half, _SIDE_PAVEMENT_M)])
            back = self._place(a, b, hand)
            t = np.linspace(0.0, 1.0, 3)[:, None, None]
            pieces.append(
                drape.sheet(inner + t * (back - inner), top, texture["paving"], tile_m=4.0, tint=(0.92, 0.92, 0.92))
            )
            lawn = np.meshgrid(
                np.linspace(_PAVEMENT_M - _UNDER_M, _PAVEMENT_M + _LAWN_M, 5),
                np.linspace(_SIDE_PAVEMENT_M - _UNDER_M, _SIDE_PAVEMENT_M + _LAWN_M, 5),
            )
            pieces.append(drape.sheet(self._place(lawn[0], lawn[1], hand), top - 0.012, texture["grass"], tile_m=5.0))
        return merged(pieces)
