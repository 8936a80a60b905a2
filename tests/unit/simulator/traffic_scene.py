# SPDX-License-Identifier: Apache-2.0
"""What the tests of the town's traffic share: planned towns, and rectangles on the ground."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.actor import Actor
from services.simulator.options import DriveOptions
from services.simulator.worlds.town.plan import TownPlan
from services.simulator.worlds.town.survey import survey_town
from services.simulator.worlds.town.traffic.camera_car import CarCamera
from services.simulator.worlds.town.traffic.planner import plan_traffic

Floats = NDArray[np.float64]

CAMERA_CAR_M = (4.4, 1.8)
CAMERA_AHEAD_M = 1.1


@cache
def town(seed: int) -> TownPlan:
    """The plan of a town."""
    return survey_town(DriveOptions(world="town", seed=seed)).plan


@cache
def planned(options: DriveOptions) -> tuple[list[Actor], CarCamera]:
    """Everybody in it; textures do not matter."""
    return plan_traffic(options, town(options.seed), defaultdict(int))


def camera_car(camera: CarCamera, t_s: float) -> Floats:
    """Rectangle of the camera's car, (4, 2)."""
    pose = camera.world_from_camera(t_s)
    ahead = pose[:2, 2] / np.hypot(*pose[:2, 2])
    frame = np.array([ahead, [-ahead[1], ahead[0]]])
    return rectangle(pose[:2, 3] - CAMERA_AHEAD_M * ahead, frame, CAMERA_CAR_M)


def rectangle(centre: Floats, frame: Floats, size_m: Sequence[float]) -> Floats:
    """Corners (4, 2); frame: (2, 2), rows are the directions ahead and left."""
    corners = np.array([[1, 1], [1, -1], [-1, -1], [-1, 1]]) * (0.5 * np.array(size_m[:2]))
    return np.asarray(corners @ frame + centre)


def footprint(actor: Actor, t_s: float) -> Floats:
    """Rectangle of an actor."""
    pose = actor.at(t_s).world_from_object
    return rectangle(pose[:2, 3], pose[:2, :2].T, actor.size_m)


def gaps(rectangles: Floats, pairs: NDArray[np.intp]) -> Floats:
    """How far pairs (P, 2) of rectangles (R, 4, 2) are apart, (P,), by separating axes; negative where they overlap."""
    a, b = rectangles[pairs[:, 0]], rectangles[pairs[:, 1]]
    best = np.full(len(pairs), -np.inf)
    for own in (a, b):
        for side in (0, 1):
            edge = own[:, side + 1] - own[:, side]
            normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1) / np.linalg.norm(edge, axis=1)[:, None]
            on_a, on_b = (np.einsum("pki,pi->pk", which, normal) for which in (a, b))
            apart = np.maximum(on_a.min(axis=1) - on_b.max(axis=1), on_b.min(axis=1) - on_a.max(axis=1))
            best = np.maximum(best, apart)
    return best
