# SPDX-License-Identifier: Apache-2.0
"""A world at one time: where the camera is, who is near, and the surfaces to look at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from services.simulator.actors.actor import Actor, ActorState
from services.simulator.camera.camera import Camera
from services.simulator.rendering.bounds import BOX_CORNERS, windows
from services.simulator.rendering.contact import Footprint
from services.simulator.rendering.nearest import Surfaces
from services.simulator.rendering.triangles import TriangleTable, joined, table_of
from services.simulator.rendering.whereabouts import Reach, Whereabouts
from services.simulator.shapes.meshes import merged
from services.simulator.worlds.world import World

Floats = NDArray[np.float64]

_VIEW_RANGE_M = 180.0
"""Moving actors farther away than this are left out: three pixels of the default lens."""
_SHADOW_RANGE_M = 50.0
"""Whoever is as near as this is there although not in sight, where shadows are cast."""
_TILT = 1.2
"""How much wider a camera sees on the plane for being tilted a little."""
_LIMBS_M = 0.4
"""How far limbs may swing beyond the cuboid."""


@dataclass(frozen=True)
class Moment:
    """A world at time t_s. world_from_camera: 4x4. near: who may be in sight or throw shade, in order of their ids."""

    t_s: float
    world_from_camera: Floats
    near: Sequence[tuple[Actor, ActorState]]
    moving: Surfaces | None
    moving_actors: Sequence[Actor]

    @cached_property
    def footprints(self) -> list[Footprint]:
        """Of everybody near; a bicycle hides little of the sky, its rider throws shade enough for both."""
        return [
            Footprint(state.world_from_object, *actor.size_m[:2])
            for actor, state in self.near
            if actor.category != "bicycle"
        ]

    def corners_at(self, t_s: float) -> Floats:
        """Corners of the moving surfaces' triangles at another time, (T, 3, 3), world frame."""
        found = [actor.vertices_in_world(actor.at(t_s))[actor.mesh.triangles] for actor in self.moving_actors]
        return np.concatenate(found) if found else np.zeros((0, 3, 3))


class Scene:
    """Everything of a world, for a camera with a second one `baseline_m` to its right."""

    def __init__(self, world: World, camera: Camera, threads: int, baseline_m: float, shadows: bool) -> None:
        self._world, self._camera, self._threads = world, camera, threads
        self._baseline_m, self._shadows = baseline_m, shadows
        self._restless = [actor for actor in world.actors if not actor.always_still]
        self._whereabouts = Whereabouts(self._restless)
        slope = _TILT * float(np.abs(camera.normalised()[0]).max())
        self._reach = Reach(_VIEW_RANGE_M, slope, _SHADOW_RANGE_M if shadows else 0.0)
        self._still = {actor.instance_id: actor.at(0.0) for actor in world.actors if actor.always_still}
        table = table_of(world.mesh, world.mesh.vertices, np.zeros(len(world.mesh.triangles), np.int32))
        parked = [_table_at([(a, self._still[a.instance_id])]) for a in world.actors if a.always_still]
        self.static = Surfaces(joined([table, *parked]), threads)

    def at(self, t_s: float) -> Moment:
        """The moment at a time."""
        pose = self._world.camera_path.world_from_camera(t_s)
        near = self._near(pose, t_s)
        moving = [(actor, state) for actor, state in near if not actor.always_still]
        if moving and not self._shadows:
            boxes = windows(self._camera, self._boxes(moving, pose))
            moving = [pair for pair, window in zip(moving, boxes, strict=True) if window is not None]
        surfaces = Surfaces(_table_at(moving), self._threads) if moving else None
        return Moment(t_s, pose, near, surfaces, [actor for actor, _ in moving])

    def _near(self, world_from_camera: Floats, t_s: float) -> list[tuple[Actor, ActorState]]:
        near = [(actor, self._still[actor.instance_id]) for actor in self._world.actors if actor.always_still]
        for number in self._whereabouts.perhaps_in_sight(world_from_camera, t_s, self._reach):
            actor = self._restless[number]
            state = actor.at(t_s)
            if not state.present:
                continue
            away = state.centre_m[:2] - world_from_camera[:2, 3]
            distance = float(np.hypot(*away))
            ahead = float(away @ world_from_camera[:2, 2]) > -actor.size_m[0]
            if (ahead and distance < _VIEW_RANGE_M) or (self._shadows and distance < _SHADOW_RANGE_M):
                near.append((actor, state))
        return sorted(near, key=lambda pair: pair[0].instance_id)

    def _boxes(self, moving: Sequence[tuple[Actor, ActorState]], world_from_camera: Floats) -> Floats:
        """Corners of boxes round actors in the camera's frame, (A, 8, 3), wide enough for both cameras."""
        size = np.array([actor.size_m for actor, _ in moving])
        half = 0.5 * size + _LIMBS_M + self._baseline_m
        corners = np.where(BOX_CORNERS, half[:, None], -half[:, None])
        rotation = np.array([state.world_from_object[:3, :3] for _, state in moving])
        centre = np.array([state.centre_m for _, state in moving])
        in_world = corners @ rotation.transpose(0, 2, 1) + centre[:, None]
        return np.asarray((in_world - world_from_camera[:3, 3]) @ world_from_camera[:3, :3])


def _table_at(actors: Sequence[tuple[Actor, ActorState]]) -> TriangleTable:
    """One table of all of them, where they are."""
    mesh = merged([actor.mesh for actor, _ in actors])
    vertices = np.concatenate([actor.vertices_in_world(state) for actor, state in actors])
    ids = np.array([actor.instance_id for actor, _ in actors], np.int32)
    return table_of(mesh, vertices, np.repeat(ids, [len(actor.mesh.triangles) for actor, _ in actors]))
