# SPDX-License-Identifier: Apache-2.0
"""The simulator's face: one drive through one world."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from services.runtime.errors import InputError
from services.simulator.actors.actor import Actor
from services.simulator.camera.camera import Camera
from services.simulator.camera.sensor import Sensor
from services.simulator.camera.timeline import Timeline
from services.simulator.frame import SimulatedFlow, SimulatedFrame
from services.simulator.options import DriveOptions
from services.simulator.rendering.bands import Bands
from services.simulator.rendering.flow import FlowTruth, MovedTriangles, View
from services.simulator.rendering.instances import visible_instances
from services.simulator.rendering.light import LIGHTS
from services.simulator.rendering.nearest import Sight
from services.simulator.rendering.renderer import RenderedView, Renderer
from services.simulator.rendering.scene import Moment, Scene
from services.simulator.rendering.shading import Shader
from services.simulator.worlds.build import build_world

Image = NDArray[np.uint8]
Floats = NDArray[np.float64]

_KEPT = 2
"""Moments of which the surfaces seen are kept: a frame's flow looks at the next one, which is mostly asked for next."""


class Drive:
    """A drive through a world. `render(i)` and `flow(i)` are pure functions of (options, i), in any order.

    camera: K, lens, width, height. actors: everybody, also those not in sight. frame_count: frames of the drive.
    Not to be used by two threads at a time.

    Raises:
        InputError: options that cannot be met.
    """

    def __init__(self, options: DriveOptions | None = None) -> None:
        self.options = options or DriveOptions()
        self.camera = Camera.from_options(self.options)
        self._timeline = Timeline(self.options)
        self._sensor = Sensor(self.options)
        # The world has to reach as far as a drive whose missing frames had come.
        world = build_world(replace(self.options, frames=self._timeline.times))
        self.actors: list[Actor] = world.actors
        self.camera_path = world.camera_path
        bands = Bands(self.options.threads)
        light, shadows = world.light or LIGHTS[self.options.light], self.options.shadows
        self._scene = Scene(world, self.camera, bands.threads, self.options.stereo_baseline_m, shadows)
        shader = Shader(world.atlas, world.atlas.index[world.sky_texture], light)
        self._renderer = Renderer(self.camera, self._scene.static, shader, bands, shadows)
        self._flow_truth = FlowTruth(self.camera, bands)
        self._seen: OrderedDict[int, tuple[Moment, Sight]] = OrderedDict()

    @property
    def frame_count(self) -> int:
        """Frames of the drive."""
        return self.options.frames

    def timestamp_ns(self, index: int) -> int:
        """Capture time of a frame, nanoseconds since the start."""
        return self._timeline.timestamp_ns(self._checked(index))

    def world_from_camera(self, index: int) -> Floats:
        """Pose of the (left) camera at a frame, 4x4, without rendering it."""
        return self.camera_path.world_from_camera(self._time_s(index))

    def render(self, index: int) -> SimulatedFrame:
        """The frame at `index`.

        Raises:
            InputError: no such frame.
        """
        moment, sight = self._seen_at(index)
        view, hits = self._renderer.render(sight, moment.footprints), sight.hits
        shown = self._timeline.shown(index)
        image, right = self._images(shown) if shown != index else self._images(index, view)
        depth = np.where(np.isfinite(hits.depth_m), hits.depth_m, np.float32(0.0))
        labels = view.instance.astype(np.uint16)
        found = visible_instances(labels, moment.near)
        pose = moment.world_from_camera
        return SimulatedFrame(index, self.timestamp_ns(index), image, depth, labels, found, pose, right)

    def flow(self, index: int) -> SimulatedFlow:
        """Exact flow of the (left) camera from the frame at `index` to the next one.

        Raises:
            InputError: no such frame, or it is the last one.
        """
        if index == self.frame_count - 1:
            raise InputError(f"simulator flow of frame {index}: expected a frame before it, the last one has no next")
        next_t_s = self._time_s(index + 1)
        moment, sight = self._seen_at(index)
        _, next_sight = self._seen_at(index + 1)
        moved = self._moved(moment, next_t_s)
        then = View(next_sight.world_from_camera, next_sight.hits)
        return self._flow_truth.between(sight.hits, sight.world_from_camera, moved, then)

    def _images(self, index: int, view: RenderedView | None = None) -> tuple[Image, Image | None]:
        """What both cameras deliver of the light at a frame."""
        baseline_m = self.options.stereo_baseline_m
        if self._timeline.is_black(index):
            black = [self._sensor.black((self.camera.height, self.camera.width, 3), index, eye) for eye in range(2)]
            return black[0], black[1] if baseline_m else None
        moment, sight = self._seen_at(index)
        left = self._exposed(index, moment, view or self._renderer.render(sight, moment.footprints), 0.0)
        if not baseline_m:
            return left, None
        beside = self._renderer.sight(_beside(moment.world_from_camera, baseline_m), moment.moving)
        seen = self._renderer.render(beside, moment.footprints)
        return left, self._exposed(index, moment, seen, baseline_m)

    def _exposed(self, index: int, moment: Moment, view: RenderedView, baseline_m: float) -> Image:
        flow_px = None
        if self._sensor.blur is not None:
            next_t_s = moment.t_s + 1.0 / self.options.rate_hz
            pose, next_pose = (
                _beside(pose, baseline_m)
                for pose in (moment.world_from_camera, self.camera_path.world_from_camera(next_t_s))
            )
            moved = self._moved(moment, next_t_s)
            flow_px = self._flow_truth.between(view.hits, pose, moved, View(next_pose, None)).flow_px
        return self._sensor.exposed(view.image, flow_px, index, moment.t_s, int(baseline_m > 0.0))

    def _seen_at(self, index: int) -> tuple[Moment, Sight]:
        """The moment of a frame and what the (left) camera sees of it."""
        if index not in self._seen:
            moment = self._scene.at(self._time_s(index))
            self._seen[index] = moment, self._renderer.sight(moment.world_from_camera, moment.moving)
        self._seen.move_to_end(index)
        if len(self._seen) > _KEPT:
            self._seen.popitem(last=False)
        return self._seen[index]

    def _moved(self, moment: Moment, next_t_s: float) -> MovedTriangles:
        before = moment.moving.table.corner if moment.moving else np.zeros((0, 3, 3))
        return MovedTriangles(len(self._scene.static.table), before, moment.corners_at(next_t_s))

    def _time_s(self, index: int) -> float:
        return self._timeline.timestamp_ns(self._checked(index)) * 1e-9

    def _checked(self, index: int) -> int:
        if not 0 <= index < self.frame_count:
            raise InputError(f"simulator frame {index}: expected 0 to {self.frame_count - 1}")
        return index


def _beside(world_from_camera: Floats, baseline_m: float) -> Floats:
    """Pose of a camera so far to the right."""
    pose = world_from_camera.copy()
    pose[:3, 3] += baseline_m * world_from_camera[:3, 0]
    return pose
