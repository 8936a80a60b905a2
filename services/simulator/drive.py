# SPDX-License-Identifier: Apache-2.0
"""The simulator's face: one drive through one world."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.runtime.errors import InputError
from services.simulator.actors.actor import Actor, ActorState
from services.simulator.camera.pinhole import PinholeCamera
from services.simulator.frame import SimulatedFlow, SimulatedFrame, SimulatedInstance
from services.simulator.options import DriveOptions
from services.simulator.rendering.contact import Footprint
from services.simulator.rendering.flow import View, flow_between
from services.simulator.rendering.renderer import Renderer, Surfaces
from services.simulator.rendering.triangles import TriangleTable, joined, table_of
from services.simulator.worlds.build import build_world

_VIEW_RANGE_M = 180.0
"""Moving actors farther away than this are left out: three pixels of the default lens."""


class Drive:
    """A drive through a world. `render(i)` and `flow(i)` are pure functions of (options, i), in any order.

    camera: K, width, height. actors: everybody, also those not in sight. frame_count: frames of the drive.

    Raises:
        InputError: options that cannot be met.
    """

    def __init__(self, options: DriveOptions | None = None) -> None:
        self.options = options or DriveOptions()
        self.camera = PinholeCamera.from_options(self.options)
        world = build_world(self.options)
        self.actors: list[Actor] = world.actors
        self.camera_path = world.camera_path
        table = table_of(world.mesh, world.mesh.vertices, np.zeros(len(world.mesh.triangles), np.int32))
        self._still = {actor.instance_id: actor.at(0.0) for actor in self.actors if actor.always_still}
        parked = [_table_at(actor, self._still[actor.instance_id]) for actor in self.actors if actor.always_still]
        self._static = Surfaces(joined([table, *parked]), self.options.threads)
        self._renderer = Renderer(self.camera, self._static, world.atlas, world.sky_texture)

    @property
    def frame_count(self) -> int:
        """Frames of the drive."""
        return self.options.frames

    def timestamp_ns(self, index: int) -> int:
        """Capture time of a frame, nanoseconds since the start."""
        return self.options.timestamp_ns(self._checked(index))

    def world_from_camera(self, index: int) -> NDArray[np.float64]:
        """Camera pose of a frame, 4x4, without rendering it."""
        return self.camera_path.world_from_camera(self._time_s(index))

    def render(self, index: int) -> SimulatedFrame:
        """The frame at `index`.

        Raises:
            InputError: no such frame.
        """
        t_s = self._time_s(index)
        pose = self.camera_path.world_from_camera(t_s)
        near = self._actors_near(pose, t_s)
        footprints = [Footprint(state.world_from_object, *actor.size_m[:2]) for actor, state in near]
        view = self._renderer.render(pose, self._moving_surfaces(near), footprints)
        depth = np.where(np.isfinite(view.hits.depth_m), view.hits.depth_m, np.float32(0.0))
        labels = view.instance.astype(np.uint16)
        instances = _visible(labels, near)
        return SimulatedFrame(index, self.timestamp_ns(index), view.image, depth, labels, instances, pose)

    def flow(self, index: int) -> SimulatedFlow:
        """Exact flow from the frame at `index` to the next one.

        Raises:
            InputError: no such frame, or it is the last one.
        """
        t_s, next_t_s = self._time_s(index), self._time_s(index + 1)
        pose, next_pose = self.camera_path.world_from_camera(t_s), self.camera_path.world_from_camera(next_t_s)
        now = self._renderer.cast(pose, self._moving_surfaces(self._actors_near(pose, t_s)))
        then = self._renderer.cast(next_pose, self._moving_surfaces(self._actors_near(next_pose, next_t_s)))
        corners_now, corners_then = (
            np.concatenate(
                [
                    self._static.table.corner,
                    *(
                        actor.vertices_in_world(actor.at(t))[actor.mesh.triangles]
                        for actor, _ in self._actors_near(pose, t_s)
                        if not actor.always_still
                    ),
                ]
            )
            for t in (t_s, next_t_s)
        )
        return flow_between(self.camera, View(now, pose), View(then, next_pose), corners_now, corners_then)

    def _time_s(self, index: int) -> float:
        return self.options.timestamp_ns(self._checked(index)) * 1e-9

    def _checked(self, index: int) -> int:
        if not 0 <= index < self.frame_count:
            raise InputError(f"simulator frame {index}: expected 0 to {self.frame_count - 1}")
        return index

    def _actors_near(self, world_from_camera: NDArray[np.float64], t_s: float) -> list[tuple[Actor, ActorState]]:
        """Those that may be in sight, in order of their ids."""
        near = []
        for actor in self.actors:
            if actor.always_still:
                near.append((actor, self._still[actor.instance_id]))
                continue
            state = actor.at(t_s)
            away = state.centre_m[:2] - world_from_camera[:2, 3]
            ahead = float(away @ world_from_camera[:2, 2])
            if state.present and ahead > -actor.size_m[0] and float(np.hypot(*away)) < _VIEW_RANGE_M:
                near.append((actor, state))
        return near

    def _moving_surfaces(self, near: list[tuple[Actor, ActorState]]) -> Surfaces | None:
        """Surfaces of those that are not part of the static scene."""
        tables = [_table_at(actor, state) for actor, state in near if not actor.always_still]
        return Surfaces(joined(tables), self.options.threads) if tables else None


def _visible(labels: NDArray[np.uint16], near: list[tuple[Actor, ActorState]]) -> list[SimulatedInstance]:
    """Everybody with at least one pixel, in order of their ids."""
    rows, columns = np.nonzero(labels)
    ids = labels[rows, columns]
    found = []
    for actor, state in near:
        mine = np.flatnonzero(ids == actor.instance_id)
        if not len(mine):
            continue
        x, y = int(columns[mine].min()), int(rows[mine[0]])
        box = (x, y, int(columns[mine].max()) - x + 1, int(rows[mine[-1]]) - y + 1)
        found.append(
            SimulatedInstance(
                actor.instance_id,
                actor.category,
                state.moving,
                state.velocity_m_s,
                state.centre_m,
                state.heading_rad,
                actor.size_m,
                box,
                len(mine),
            )
        )
    return found


def _table_at(actor: Actor, state: ActorState) -> TriangleTable:
    instance = np.full(len(actor.mesh.triangles), actor.instance_id, np.int32)
    return table_of(actor.mesh, actor.vertices_in_world(state), instance)
