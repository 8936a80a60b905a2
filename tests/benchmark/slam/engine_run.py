# SPDX-License-Identifier: Apache-2.0
"""One pass of the engine over frames, without a bus, and what came of it."""

import hashlib
import resource
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from schemas.codec.rigid import matrix_from_pose
from services.slam import _engine
from tests.benchmark.slam.sequence_part import SequenceFrame, SequencePart

Array = npt.NDArray[np.float64]
Update = dict[str, npt.NDArray[Any]]

TRACKING = 1
FRAME_NS = 100_000_000


class FrameClock:
    """Processor time of this process from frame to frame, without what this thread does between them: reading."""

    def __init__(self) -> None:
        self._process_s = time.process_time()
        self._thread_s = time.thread_time()
        self._reading_s = 0.0

    def read_ms(self) -> float:
        """A frame was read. Time that took."""
        self._reading_s = time.thread_time() - self._thread_s
        return self._reading_s * 1e3

    def end_ms(self) -> float:
        """Time since the last call."""
        before, self._process_s = self._process_s, time.process_time()
        self._thread_s = time.thread_time()
        return (self._process_s - before - self._reading_s) * 1e3


@dataclass
class EngineRun:
    """Frame poses relative to keyframes, the keyframes' newest poses, and a digest of every byte that came out."""

    engine: _engine.Engine
    relative: dict[int, tuple[int, Array]] = field(default_factory=dict)
    """frame index -> reference keyframe, camera_from_reference in the units of what is anchored there"""
    keyframes: dict[int, tuple[Array, float]] = field(default_factory=dict)
    """keyframe -> map_from_keyframe, map units in a unit of what is anchored there"""
    map_of_keyframe: dict[int, int] = field(default_factory=dict)
    culled: set[int] = field(default_factory=set)
    landmarks: dict[int, int] = field(default_factory=dict)
    """landmark -> state"""
    results: list[_engine.TrackingResult] = field(default_factory=list)
    wall_ms: list[float] = field(default_factory=list)
    cpu_ms: list[float] = field(default_factory=list)
    """processor time of all threads for a frame, with what the background did since the frame before"""
    read_ms: list[float] = field(default_factory=list)
    """the same for reading the frame's images: equal work each time, so that it tells how fast the machine is then"""
    rss_mb: list[float] = field(default_factory=list)
    """resident memory of this process after each frame"""
    sizes: list[tuple[int, int]] = field(default_factory=list)
    """live keyframes and landmarks after each frame"""
    digest: "hashlib._Hash" = field(default_factory=hashlib.sha256)
    _clock: FrameClock = field(default_factory=FrameClock)
    on_update: Callable[[Update], None] | None = None
    """gets every map update, for what is not kept here"""

    def step(self, frame: SequenceFrame) -> None:
        """Track the next frame."""
        index, objects = len(self.results), frame.objects
        self.read_ms.append(self._clock.read_ms())
        start = time.perf_counter()
        self.engine.begin_frame((index + 1) * FRAME_NS, frame.image, frame.right)
        result = self.engine.finish_frame(*objects, masks_fresh=True)
        self.wall_ms.append((time.perf_counter() - start) * 1e3)
        self.results.append(result)
        self.rss_mb.append(resident_mb())
        if result.state == TRACKING:
            self.relative[index] = (result.reference_keyframe_id, result.camera_from_reference)
            self.digest.update(result.map_from_camera.tobytes())
        self._take()
        self.cpu_ms.append(self._clock.end_ms())
        self.sizes.append((len(self.keyframes) - len(self.culled), len(self.landmarks)))

    def finish(self) -> None:
        """The end of the input."""
        self.engine.flush()
        self._take()

    def main_map(self) -> int:
        """The map that holds most frames; 0 while there is none."""
        maps = Counter(self.map_of_keyframe[reference] for reference, _ in self.relative.values())
        return max(maps, key=lambda number: (maps[number], -number), default=0)

    def centers(self) -> tuple[list[int], Array]:
        """Indices of the frames in the main map, and their camera centres (N, 3) as the map is now."""
        main = self.main_map()
        indices = [i for i, (reference, _) in sorted(self.relative.items()) if self.map_of_keyframe[reference] == main]
        return indices, np.array([self._center(*self.relative[index]) for index in indices]).reshape(-1, 3)

    def online_centers(self) -> tuple[list[int], Array]:
        """The same as they were told at each frame, before any later correction; only frames of the main map."""
        main = self.main_map()
        told = [i for i, r in enumerate(self.results) if r.state == TRACKING and r.map_id == main]
        return told, np.array([self.results[index].map_from_camera[:3, 3] for index in told]).reshape(-1, 3)

    def initialized_at(self) -> int:
        """Index of the first frame with a pose of its own; -1 when there is none."""
        return next((index for index, result in enumerate(self.results) if result.state == TRACKING), -1)

    def tracked_share(self) -> float:
        """Share of the frames since initialisation that were tracked."""
        after = self.results[max(self.initialized_at(), 0) :]
        return sum(result.state == TRACKING for result in after) / len(after)

    def _center(self, reference: int, camera_from_reference: Array) -> Array:
        map_from_keyframe, scale = self.keyframes[reference]
        in_reference = np.linalg.inv(camera_from_reference)[:3, 3]
        center: Array = map_from_keyframe[:3, :3] @ (scale * in_reference) + map_from_keyframe[:3, 3]
        return center

    def _take(self) -> None:
        update = self.engine.take_map_update()
        if self.on_update is not None:
            self.on_update(update)
        for name in sorted(update):
            self.digest.update(update[name].tobytes())
        for row, number in enumerate(update["keyframe_id"].tolist()):
            pose = update["keyframe_pose"][row]
            self.keyframes[number] = matrix_from_pose(pose[:7]), float(pose[7])
            self.map_of_keyframe[number] = int(update["keyframe_map_id"][row])
            if update["keyframe_culled"][row]:
                self.culled.add(number)
        self.landmarks.update(zip(update["landmark_id"].tolist(), update["landmark_state"].tolist(), strict=True))
        for number in update["removed_landmark_id"].tolist():
            del self.landmarks[number]
        for row, timestamp_ns in enumerate(update["frame_timestamp_ns"].tolist()):
            reference = int(update["frame_reference_keyframe_id"][row])
            pose = matrix_from_pose(update["frame_camera_from_reference"][row])
            self.relative[timestamp_ns // FRAME_NS - 1] = (reference, pose)


def resident_mb() -> float:
    """Resident memory of this process."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 2**20


def run_parts(
    parts: tuple[SequencePart, ...],
    options: _engine.EngineOptions,
    on_update: Callable[[Update], None] | None = None,
) -> EngineRun:
    """Show the engine one part after the other, as one input; the camera is the first part's."""
    run: EngineRun | None = None
    for part in parts:
        for frame in part.read():
            if run is None:
                height, width = frame.image.shape
                camera = _engine.CameraModel(width, height, *part.intrinsics(), [], part.baseline_m())
                run = EngineRun(_engine.Engine(camera, options), on_update=on_update)
            run.step(frame)
    if run is None:
        raise FileNotFoundError(f"{parts[0].folder}: no frame from number {parts[0].start} on")
    run.finish()
    return run
