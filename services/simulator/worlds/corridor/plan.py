# SPDX-License-Identifier: Apache-2.0
"""The floor's plan: a block of rooms, the corridor all round it, and bays that open off the corridor.

Plan frame: the block's corner at the origin, x and y along its sides, z up, metres. The world frame is that of the
camera's start: x forward, y left.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.placement import planar_pose
from services.simulator.worlds.line import SampledLine

Floats = NDArray[np.float64]

HALF_WIDTH_M = 1.3
CEILING_M = 2.8
_STEPS_A_METRE = 20


@dataclass(frozen=True, slots=True)
class Bay:
    """A room without a wall towards the corridor, on outer side `side`, from `begin_m` on along it."""

    side: int
    begin_m: float
    length_m: float
    depth_m: float


@dataclass(frozen=True, slots=True)
class Wall:
    """A wall along x of its own frame, y pointing into the corridor. world_from_wall: 4x4; length_m: along x."""

    world_from_wall: Floats
    length_m: float


class FloorPlan:
    """One floor. line: centre of the corridor in the world frame, closed, s = 0 at the camera's start.

    outer, inner: four walls each; bays: cut out of the outer ones.
    """

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng([seed, 21])
        self.size_m = (float(rng.uniform(16.0, 27.0)), float(rng.uniform(9.0, 16.0)))
        self.bays = _draw_bays(rng, self.size_m)
        reverse = bool(rng.random() < 0.5)
        plan_line = _centre_line(self.size_m, reverse)
        start = planar_pose(plan_line.point(0.0, 0.0), float(plan_line.heading(0.0)))
        self.world_from_plan = np.asarray(np.linalg.inv(start), np.float64)
        around = plan_line.length_m
        heading = plan_line.heading(np.linspace(0.0, around, round(around * _STEPS_A_METRE) + 1))
        self.line = SampledLine(heading - float(plan_line.heading(0.0)), around, np.zeros(2), closed=True)
        self.outer = [self._wall(pose, length) for pose, length in _outer_sides(self.size_m)]
        self.inner = [self._wall(pose, length) for pose, length in _inner_sides(self.size_m)]

    def world_from_bay(self, bay: Bay) -> Floats:
        """Frame of a bay, 4x4: origin at the middle of its opening, x along the wall, y towards the corridor."""
        in_wall = np.eye(4)
        in_wall[0, 3] = bay.begin_m + 0.5 * bay.length_m
        return np.asarray(self.outer[bay.side].world_from_wall @ in_wall)

    def _wall(self, plan_from_wall: Floats, length_m: float) -> Wall:
        return Wall(self.world_from_plan @ plan_from_wall, length_m)


def _draw_bays(rng: np.random.Generator, size_m: tuple[float, float]) -> list[Bay]:
    """Two to four bays, at most two a side, never at a corner."""
    bays = []
    for side in range(4):
        length = size_m[side % 2] + 4.0 * HALF_WIDTH_M
        position = 3.4 + float(rng.uniform(0.0, 2.0))
        for _ in range(2):
            width, depth = float(rng.uniform(3.2, 7.5)), float(rng.uniform(2.6, 5.2))
            if rng.random() < 0.55 and position + width < length - 3.4:
                bays.append(Bay(side, position, width, depth))
            position += width + float(rng.uniform(2.5, 5.0))
    if not bays:
        bays.append(Bay(0, 4.0, 5.0, 4.0))
    return bays


def _centre_line(size_m: tuple[float, float], reverse: bool) -> SampledLine:
    """Round the block at half the corridor's width, from the middle of its first side on."""
    turn = 0.5 * np.pi * HALF_WIDTH_M
    sides = [0.5 * size_m[0], size_m[1], size_m[0], size_m[1], 0.5 * size_m[0]]
    way, heading = [0.0], [0.0]
    for number, side in enumerate(sides):
        way.append(way[-1] + side)
        heading.append(heading[-1])
        if number < 4:
            way.append(way[-1] + turn)
            heading.append(heading[-1] + 0.5 * np.pi)
    samples = np.linspace(0.0, way[-1], round(way[-1] * _STEPS_A_METRE) + 1)
    angle = np.interp(samples, way, heading)
    if reverse:
        angle = angle[::-1] + np.pi
    return SampledLine(angle, way[-1], np.array([0.5 * size_m[0], -HALF_WIDTH_M]), closed=True)


def _outer_sides(size_m: tuple[float, float]) -> list[tuple[Floats, float]]:
    (width, height), out = size_m, 2.0 * HALF_WIDTH_M
    corners = [(-out, -out), (width + out, -out), (width + out, height + out), (-out, height + out)]
    return [
        (planar_pose(np.array(corner), 0.5 * np.pi * side), size_m[side % 2] + 2.0 * out)
        for side, corner in enumerate(corners)
    ]


def _inner_sides(size_m: tuple[float, float]) -> list[tuple[Floats, float]]:
    """Walked round the other way, so that the corridor is on the left here too."""
    width, height = size_m
    corners = [(width, 0.0), (0.0, 0.0), (0.0, height), (width, height)]
    return [
        (planar_pose(np.array(corner), np.pi - 0.5 * np.pi * side), size_m[side % 2])
        for side, corner in enumerate(corners)
    ]
