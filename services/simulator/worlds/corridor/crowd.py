# SPDX-License-Identifier: Apache-2.0
"""Who is on the floor: what could be carried away from the bays, and the people."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.actor import Actor
from services.simulator.actors.motion import Path, SpeedProfile
from services.simulator.actors.placement import planar_pose
from services.simulator.options import DriveOptions
from services.simulator.shapes import people
from services.simulator.worlds.corridor.bays import Piece, bay_furniture
from services.simulator.worlds.corridor.paths import AlongCorridor, Standing, ToAndFro
from services.simulator.worlds.corridor.plan import Bay, FloorPlan
from services.simulator.worlds.corridor.walkers import LANE_M, file_of_walkers

Floats = NDArray[np.float64]

_PERSON_RADIUS_M = 0.34
_ROOM_M = 4.0
"""Way of a file that one walker has at full traffic."""
_TURN_M = 0.3
_STILL = SpeedProfile([(0.0, 0.0), (1.0, 0.0)])


class Crowd:
    """Draws everybody; nobody is drawn where anything else stands or walks."""

    def __init__(self, options: DriveOptions, plan: FloorPlan, texture: Mapping[str, int]) -> None:
        self._options, self._plan, self._texture = options, plan, texture
        self._rng = np.random.default_rng([options.seed_of_traffic, 24])
        self._actors: list[Actor] = []

    def plan(self) -> list[Actor]:
        """All actors; their ids count from 1, and those of the furniture do not depend on the traffic."""
        furnished = [(bay, bay_furniture(bay, self._options.seed, self._texture)) for bay in self._plan.bays]
        for bay, furniture in furnished:
            for piece in furniture.pieces:
                self._put(piece, self._plan.world_from_bay(bay) @ piece.bay_from_object)
        for bay, furniture in furnished:
            self._people_in(bay, list(furniture.taken))
        self._people_in_corridor()
        return self._actors

    def _put(self, piece: Piece, world_from_object: Floats) -> None:
        self._actors.append(
            Actor(
                len(self._actors) + 1,
                piece.category,
                piece.mesh,
                piece.size_m,
                Standing(world_from_object),
                _STILL,
                None,
                0.5 * max(piece.size_m[:2]),
                (0.0,),
            )
        )

    def _person(self, path: Path, speed: SpeedProfile) -> None:
        rng = self._rng
        height = float(rng.uniform(1.55, 1.92))
        jacket = int(rng.integers(0, people.JACKET_COUNT))
        mesh, gait = people.person_mesh(jacket, height, self._texture, bool(rng.random() < 0.3))
        size = (people.PERSON_SIZE_M[0], people.PERSON_SIZE_M[1], height)
        number = len(self._actors) + 1
        self._actors.append(Actor(number, "person", mesh, size, path, speed, gait, _PERSON_RADIUS_M, (0.0,)))

    def _people_in(self, bay: Bay, taken: list[tuple[float, float, float]]) -> None:
        """One or two who stand, in talk with each other, and one who walks to and fro."""
        world_from_bay = self._plan.world_from_bay(bay)
        if self._rng.random() < self._options.traffic + 0.2 and bay.length_m > 3.6:
            length = bay.length_m - 2.4
            y = -0.55
            ends = np.array([[-0.5 * length, y, 0.0], [0.5 * length, y, 0.0]])
            if not any(_gap(ends[:, :2], disc) < disc[2] + _PERSON_RADIUS_M + _TURN_M for disc in taken):
                in_world = ends @ world_from_bay[:3, :3].T + world_from_bay[:3, 3]
                pace = float(self._rng.uniform(0.7, 1.1)) if self._options.traffic > 0.0 else 0.0
                path = ToAndFro(in_world[0, :2], in_world[1, :2], _TURN_M)
                self._person(path, SpeedProfile([(0.0, pace), (1.0, pace)]))
                taken.append((0.0, y, 0.5 * length + _TURN_M + _PERSON_RADIUS_M))
        for _ in range(int(self._rng.integers(0, 3))):
            at = self._free_place(bay, taken)
            if at is not None:
                taken.append((*at, _PERSON_RADIUS_M))
                pose = planar_pose(np.array(at), float(self._rng.uniform(-np.pi, np.pi)))
                self._person(Standing(world_from_bay @ pose), _STILL)

    def _free_place(self, bay: Bay, taken: list[tuple[float, float, float]]) -> tuple[float, float] | None:
        half, margin = 0.5 * bay.length_m, 0.5
        for _ in range(30):
            x = float(self._rng.uniform(-half + margin, half - margin))
            y = float(self._rng.uniform(-bay.depth_m + margin, -margin))
            if all(np.hypot(x - u, y - v) > radius + _PERSON_RADIUS_M for u, v, radius in taken):
                return x, y
        return None

    def _people_in_corridor(self) -> None:
        line = self._plan.line
        duration = self._options.frames / self._options.rate_hz + 1.0
        count = round(self._options.traffic * line.length_m / _ROOM_M)
        for direction in (1.0, -1.0):
            for walk in file_of_walkers(self._rng.spawn(1)[0], count, line.length_m, duration):
                path = AlongCorridor(line, direction * walk.s_m, direction, -direction * LANE_M)
                self._person(path, walk.speed)


def _gap(ends: Floats, disc: tuple[float, float, float]) -> float:
    """Distance of a disc's centre from the stretch between two points of the bay's plane."""
    way = ends[1] - ends[0]
    along = float(np.clip((np.array(disc[:2]) - ends[0]) @ way / (way @ way), 0.0, 1.0))
    return float(np.hypot(*(ends[0] + along * way - np.array(disc[:2]))))
