# SPDX-License-Identifier: Apache-2.0
"""Who is in the street and how they move: drawn from the seed, and admitted only if they never touch anybody."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from services.runtime.errors import InputError
from services.simulator.actors.actor import MOVING_M_S, Actor
from services.simulator.actors.motion import Path, SpeedProfile
from services.simulator.options import DriveOptions
from services.simulator.shapes import people
from services.simulator.shapes.meshes import Mesh, Tint
from services.simulator.shapes.vehicles import cars
from services.simulator.worlds.street.ego import EgoTrajectory
from services.simulator.worlds.street.paths import AcrossPath, LanePath
from services.simulator.worlds.street.road import BAY_CENTRE_M, LANE_CENTRE_M, Road

Floats = NDArray[np.float64]

_TRIES = 500
_TIME_STEP_S = 0.2
_MARGIN_M = 0.3
_EMPTY_RADIUS_M = 31.0
_EGO_DISCS_M = (-3.2, -1.8, -0.4, 1.0, 3.0, 5.0, 7.0)
"""Discs of the camera's car along its heading; the last three keep the way ahead of it free."""
_EGO_RADIUS_M = 1.0


Route = tuple[Path, SpeedProfile]


class Looks(TypedDict):
    """What an actor is, whatever its way."""

    category: str
    mesh: Mesh
    size_m: tuple[float, float, float]
    gait: people.Gait | None
    disc_radius_m: float
    disc_offsets_m: tuple[float, ...]


class TrafficPlanner:
    """Draws actors one after another; each is drawn again until it keeps clear of the camera and of all before it."""

    def __init__(self, options: DriveOptions, road: Road, ego: EgoTrajectory, texture: Mapping[str, int]) -> None:
        self._options, self._road, self._ego, self._texture = options, road, ego, texture
        self._rng = np.random.default_rng([options.seed_of_traffic, 4])
        self._actors: list[Actor] = []
        self._car_meshes: dict[tuple[cars.BodyStyle, Tint], Mesh] = {}
        duration_s = road.length_m / options.speed_m_s
        self._times = np.arange(0.0, duration_s + 2.0, _TIME_STEP_S)
        self._discs: list[Floats] = [self._ego_discs()]
        self._radii: list[float] = [_EGO_RADIUS_M]
        self._zone_m = (options.empty_start_m + 12.0, road.length_m - 26.0)

    def plan(self) -> list[Actor]:
        """All actors; their ids count from 1.

        Raises:
            InputError: more of one kind than the street has room for.
        """
        options = self._options
        kinds: list[tuple[str, Callable[[int], Route]]] = [
            ("leading_cars", self._leading_car),
            ("crossing_cars", self._crossing_car),
            ("starting_cars", self._starting_car),
            ("oncoming_cars", self._oncoming_car),
            ("crossing_people", self._crossing_person),
            ("parked_cars", self._parked_car),
            ("walking_people", self._walking_person),
            ("standing_people", self._standing_person),
        ]
        for name, draw in kinds:
            wanted = int(getattr(options, name))
            looks = self._person if name.endswith("people") else self._car
            for number in range(wanted):
                if not self._admit(draw, looks(len(self._actors) + 1), number):
                    where = f"(seed {options.seed_of_traffic}, lateral_offset_m={options.lateral_offset_m})"
                    raise InputError(f"simulator {name}={wanted}: expected at most {number} on this street {where}")
        return self._actors

    def _admit(self, draw: Callable[[int], Route], looks: Looks, number: int) -> bool:
        for _ in range(_TRIES):
            path, speed = draw(number)
            actor = Actor(len(self._actors) + 1, path=path, speed=speed, **looks)
            discs = actor.disc_centres(self._times)
            if self._keeps_start_empty(actor) and self._keeps_clear(discs, actor.disc_radius_m):
                self._actors.append(actor)
                self._discs.append(discs)
                self._radii.append(actor.disc_radius_m)
                return True
        return False

    def _keeps_clear(self, discs: Floats, radius_m: float) -> bool:
        for other, other_radius_m in zip(self._discs, self._radii, strict=True):
            reach = radius_m + other_radius_m + _MARGIN_M
            near = np.abs(discs[:, 0] - other[:, 0]).max(axis=1) < reach + 14.0
            if near.any():
                gap = discs[near][:, :, None, :] - other[near][:, None, :, :]
                if (np.square(gap).sum(axis=-1) < reach * reach).any():
                    return False
        return True

    def _keeps_start_empty(self, actor: Actor) -> bool:
        times = self._times[self._ego.distance_m(self._times) < self._options.empty_start_m]
        if not len(times):
            return True
        away = actor.path.point(actor.speed.distance_m(times))[:, :2] - self._ego.xy(times)
        near = np.hypot(away[:, 0], away[:, 1]) < _EMPTY_RADIUS_M
        return not bool((near & (actor.speed.speed_m_s(times) >= MOVING_M_S)).any())

    def _ego_discs(self) -> Floats:
        position = self._ego.xy(self._times)
        step = self._ego.xy(self._times + 0.01) - position
        ahead = step / np.linalg.norm(step, axis=1, keepdims=True)
        return np.asarray(position[:, None] + np.array(_EGO_DISCS_M)[None, :, None] * ahead[:, None])

    def _car(self, instance_id: int) -> Looks:
        rng = np.random.default_rng([self._options.seed_of_traffic, 5, instance_id])
        style = cars.STYLES[int(rng.choice(3, p=[0.42, 0.42, 0.16]))]
        paint = cars.PAINTS[int(rng.integers(0, len(cars.PAINTS)))]
        if (style, paint) not in self._car_meshes:
            self._car_meshes[style, paint] = cars.car_mesh(style, paint, self._texture)
        half = 0.5 * style.size_m[0] - 0.75
        return Looks(
            category="car",
            mesh=self._car_meshes[style, paint],
            size_m=style.size_m,
            gait=None,
            disc_radius_m=1.05,
            disc_offsets_m=(-half, 0.0, half),
        )

    def _person(self, instance_id: int) -> Looks:
        rng = np.random.default_rng([self._options.seed_of_traffic, 5, instance_id])
        height = float(rng.uniform(1.58, 1.88))
        jacket = int(rng.integers(0, people.JACKET_COUNT))
        mesh, gait = people.person_mesh(jacket, height, self._texture, bool(rng.random() < 0.5))
        size = (people.PERSON_SIZE_M[0], people.PERSON_SIZE_M[1], height)
        return Looks(category="person", mesh=mesh, size_m=size, gait=gait, disc_radius_m=0.38, disc_offsets_m=(0.0,))

    def _meeting(self) -> tuple[float, float]:
        """A place in the traffic's part of the street and the time the camera comes there."""
        s = float(self._rng.uniform(*self._zone_m))
        return s, self._ego.time_s(s)

    def _leading_car(self, number: int) -> Route:
        """Ahead in the lane: slower until the camera has caught up with it, then as fast, then off and away."""
        cruise = self._options.speed_m_s
        slow = float(self._rng.uniform(0.5, 0.62)) * cruise
        s0 = self._options.empty_start_m + float(self._rng.uniform(14.0, 22.0)) + 34.0 * number
        gap = float(self._rng.uniform(12.5, 14.0)) + 14.0 * number
        caught = (s0 - gap) / (cruise - slow)
        follow = float(self._rng.uniform(5.0, 8.0))
        away = [(caught + follow - number, 1.02 * cruise), (caught + follow + 5.0 - number, 1.7 * cruise)]
        speed = SpeedProfile([(0.0, slow), (max(1.0, caught - 1.5), slow), (caught + 1.0, 1.02 * cruise), *away])
        return (LanePath(self._road, s0, 1.0, -LANE_CENTRE_M, -LANE_CENTRE_M), speed)

    def _crossing_car(self, number: int) -> Route:
        """Across a side street, before the camera gets there."""
        places = [s for s in self._road.junctions_m if s < self._road.length_m]
        s = float(self._rng.choice(places))
        direction = 1.0 if self._rng.random() < 0.5 else -1.0
        cruise = float(self._rng.uniform(4.5, 9.0))
        passing = self._ego.time_s(s - (10.0 + 34.0 * float(self._rng.random()) ** 3))
        start = -direction * 90.0
        arrival = (90.0 - LANE_CENTRE_M) / cruise
        speed = SpeedProfile([(passing - arrival, cruise), (passing, cruise)])
        return (AcrossPath(self._road, s + direction * LANE_CENTRE_M, start, direction), speed)

    def _starting_car(self, number: int) -> Route:
        """Parked, then off when the camera comes near; on the left it drives towards the camera."""
        s, _ = self._meeting()
        direction = 1.0 if self._rng.random() < 0.3 else -1.0
        if self._road.near_junction(s, 12.0):
            s += 24.0
        ahead = self._rng.uniform(12.0, 26.0) if direction < 0 else self._rng.uniform(20.0, 32.0)
        begin = self._ego.time_s(s - float(ahead))
        cruise = self._options.speed_m_s * float(self._rng.uniform(0.7, 1.0) if direction < 0 else 1.3)
        speed = SpeedProfile([(0.0, 0.0), (max(begin, 0.1), 0.0), (max(begin, 0.1) + cruise / 1.9, cruise)])
        side = -direction
        return (LanePath(self._road, s, direction, side * BAY_CENTRE_M, side * LANE_CENTRE_M), speed)

    def _oncoming_car(self, number: int) -> Route:
        cruise = float(self._rng.uniform(5.5, 9.0))
        s, meeting = self._meeting()
        speed = SpeedProfile([(meeting, cruise), (meeting + 1.0, cruise)])
        return (LanePath(self._road, s, -1.0, LANE_CENTRE_M, LANE_CENTRE_M), speed)

    def _parked_car(self, number: int) -> Route:
        """In a bay, preferably beside one that is already taken, so that rows grow."""
        rng = self._rng
        s = 6.0 * int(rng.integers(2, int((self._road.length_m + 60.0) / 6.0))) + float(rng.uniform(-0.2, 0.2))
        while self._road.near_junction(s, 13.0):
            s += 6.0
        direction = 1.0 if rng.random() < 0.5 else -1.0
        n = -direction * (BAY_CENTRE_M + float(rng.uniform(-0.08, 0.1)))
        return (LanePath(self._road, s, direction, n, n), SpeedProfile([(0.0, 0.0), (1.0, 0.0)]))

    def _walking_person(self, number: int) -> Route:
        """Along the pavement; every third one stops for a while."""
        rng = self._rng
        direction = 1.0 if rng.random() < 0.4 else -1.0
        n = (1.0 if rng.random() < 0.4 else -1.0) * float(rng.uniform(6.95, 7.8))
        s, meeting = self._meeting()
        pace = float(rng.uniform(1.05, 1.7))
        knots = [(meeting - 30.0, pace), (meeting + 30.0, pace)]
        gone = 30.0 * pace
        if number % 3 == 0:
            stop = meeting - float(rng.uniform(2.0, 5.0))
            knots = [(meeting - 30.0, pace), (stop, pace), (stop + 0.8, 0.0), (stop + 4.0, 0.0), (stop + 4.8, pace)]
        return (LanePath(self._road, s - direction * gone, direction, n, n), SpeedProfile(knots))

    def _crossing_person(self, number: int) -> Route:
        """Waits at the kerb, crosses before the camera, stands on the other side."""
        rng = self._rng
        s, _ = self._meeting()
        direction = 1.0 if rng.random() < 0.5 else -1.0
        pace, way = float(rng.uniform(1.2, 1.6)), 13.4
        to_lane = way / 2.0 - direction * LANE_CENTRE_M
        start = self._ego.time_s(max(1.0, s - float(rng.uniform(16.0, 34.0)))) - to_lane / pace
        start = max(start, 0.5)
        knots = [(start, 0.0), (start + 0.6, pace), (start + way / pace, pace), (start + way / pace + 0.6, 0.0)]
        return (AcrossPath(self._road, s, -direction * 0.5 * way, direction), SpeedProfile(knots))

    def _standing_person(self, number: int) -> Route:
        rng = self._rng
        s = float(rng.uniform(30.0, self._road.length_m + 20.0))
        n = (1.0 if rng.random() < 0.5 else -1.0) * float(rng.uniform(6.95, 7.8))
        turn = -1.0 if n > 0 else 1.0
        still = SpeedProfile([(0.0, 0.0), (1.0, 0.0)])
        if rng.random() < 0.5:
            return (AcrossPath(self._road, s, n, turn), still)
        return (LanePath(self._road, s, turn, n, n), still)
