# SPDX-License-Identifier: Apache-2.0
"""The simulator's face: a street, driven through once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.runtime.errors import InputError
from services.simulator.actors import Actor
from services.simulator.camera import EgoTrajectory, PinholeCamera
from services.simulator.flow import flow_between
from services.simulator.frame import SimulatedFlow, SimulatedFrame, SimulatedInstance
from services.simulator.library import paint_library
from services.simulator.options import StreetOptions
from services.simulator.renderer import Hits, Renderer, StaticScene
from services.simulator.road import Road
from services.simulator.textures import TextureAtlas
from services.simulator.traffic import TrafficPlanner
from services.simulator.triangles import TriangleTable, joined, table_of
from services.simulator.world import build_world

_VIEW_RANGE_M = 180.0
"""Actors farther away than this are left out: under five pixels high with the widest lens in use."""


class Street:
    """A drive through a street. `render(i)` and `flow(i)` are pure functions of (options, i), in any order.

    camera: K, width, height. actors: everybody, also those not in sight. frame_count: frames of the drive.

    Raises:
        InputError: options that cannot be met.
    """

    def __init__(self, options: StreetOptions | None = None) -> None:
        self.options = options or StreetOptions()
        self.camera = PinholeCamera.from_options(self.options)
        self.road = Road(self.options.drive_length_m, self.options.seed)
        self.ego = EgoTrajectory(self.options, self.road)
        atlas = TextureAtlas(paint_library(self.options.seed))
        self.actors: list[Actor] = TrafficPlanner(self.options, self.road, self.ego, atlas.index).plan()
        mesh = build_world(self.road, self.options.seed, atlas.index)
        table = table_of(mesh, mesh.vertices, np.zeros(len(mesh.triangles), np.int32))
        for actor in self.actors:
            if actor.always_still:
                table = joined(table, _table_at(actor, 0.0))
        self._renderer = Renderer(self.camera, StaticScene(table, self.options.threads), atlas)
        self._static = table

    @property
    def frame_count(self) -> int:
        """Frames of the drive."""
        return self.options.frames

    def timestamp_ns(self, index: int) -> int:
        """Capture time of a frame, nanoseconds since the start."""
        return self.options.timestamp_ns(self._checked(index))

    def world_from_camera(self, index: int) -> NDArray[np.float64]:
        """Camera pose of a frame, 4x4, without rendering it."""
        return self.ego.world_from_camera(self._time_s(index))

    def render(self, index: int) -> SimulatedFrame:
        """The frame at `index`.

        Raises:
            InputError: no such frame.
        """
        t_s = self._time_s(index)
        pose = self.ego.world_from_camera(t_s)
        actors = self._moving_actors_near(pose, t_s)
        view = self._renderer.render(pose, _tables_at(actors, t_s))
        labels = np.append(view.table.instance, 0)[view.hits.triangle].astype(np.uint16)
        depth = np.where(np.isfinite(view.hits.depth_m), view.hits.depth_m, np.float32(0.0))
        instances = self._visible(labels, t_s)
        return SimulatedFrame(index, self.timestamp_ns(index), view.image, depth, labels, instances, pose)

    def flow(self, index: int) -> SimulatedFlow:
        """Exact flow from the frame at `index` to the next one.

        Raises:
            InputError: no such frame, or it is the last one.
        """
        t_s, next_t_s = self._time_s(index), self._time_s(index + 1)
        pose, next_pose = self.ego.world_from_camera(t_s), self.ego.world_from_camera(next_t_s)
        actors = self._moving_actors_near(pose, t_s)
        now, then = self._hits(index), self._hits(index + 1)
        corners_now = self._static.corner
        corners_then = corners_now
        if actors:
            corners_now, corners_then = (
                np.concatenate([corners_now, *(a.vertices_in_world(t)[a.mesh.triangles] for a in actors)])
                for t in (t_s, next_t_s)
            )
        return flow_between(self.camera, now, then, pose, next_pose, corners_now, corners_then)

    def _hits(self, index: int) -> Hits:
        t_s = self._time_s(index)
        pose = self.ego.world_from_camera(t_s)
        return self._renderer.cast(pose, _tables_at(self._moving_actors_near(pose, t_s), t_s))[0]

    def _time_s(self, index: int) -> float:
        return self.options.timestamp_ns(self._checked(index)) * 1e-9

    def _checked(self, index: int) -> int:
        if not 0 <= index < self.frame_count:
            raise InputError(f"simulator frame {index}: expected 0 to {self.frame_count - 1}")
        return index

    def _moving_actors_near(self, world_from_camera: NDArray[np.float64], t_s: float) -> list[Actor]:
        """Those that may be in sight and are not part of the static scene."""
        origin, ahead = world_from_camera[:2, 3], world_from_camera[:2, 2]
        near = []
        for actor in self.actors:
            if not actor.always_still and bool(actor.present(t_s)):
                away = actor.centre_m(t_s)[:2] - origin
                if np.hypot(*away) < _VIEW_RANGE_M and away @ ahead > -actor.size_m[0]:
                    near.append(actor)
        return near

    def _visible(self, labels: NDArray[np.uint16], t_s: float) -> list[SimulatedInstance]:
        counts = np.bincount(labels.ravel(), minlength=len(self.actors) + 1)
        found = []
        for actor in self.actors:
            if not counts[actor.instance_id]:
                continue
            rows, columns = np.nonzero(labels == actor.instance_id)
            x, y = int(columns.min()), int(rows.min())
            box = (x, y, int(columns.max()) - x + 1, int(rows.max()) - y + 1)
            found.append(SimulatedInstance(
                actor.instance_id, actor.category, actor.moving(t_s), actor.velocity_m_s(t_s), actor.centre_m(t_s),
                float(actor.heading_rad(t_s)), actor.size_m, box, int(counts[actor.instance_id]),
            ))
        return found


def _table_at(actor: Actor, t_s: float) -> TriangleTable:
    instance = np.full(len(actor.mesh.triangles), actor.instance_id, np.int32)
    return table_of(actor.mesh, actor.vertices_in_world(t_s), instance)


def _tables_at(actors: list[Actor], t_s: float) -> TriangleTable | None:
    table = None
    for actor in actors:
        one = _table_at(actor, t_s)
        table = one if table is None else joined(table, one)
    return table
