# SPDX-License-Identifier: Apache-2.0
"""One pass of the engine over a sequence, without a bus, and what came of it."""

import hashlib
import time
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from schemas.codec.rigid import matrix_from_pose
from services.evaluation.trajectory.alignment import Alignment, align
from services.slam import _engine
from tests.benchmark.slam.mask_objects import MaskObjects

Array = npt.NDArray[np.float64]

NON_MOVING = 1
TRACKING = 1
FRAME_NS = 100_000_000


@dataclass
class EngineRun:
    """Frame poses relative to keyframes, the keyframes' newest poses, and a digest of every byte that came out."""

    engine: _engine.Engine
    relative: dict[int, tuple[int, Array]] = field(default_factory=dict)
    """frame index -> reference keyframe, camera_from_reference"""
    keyframes: dict[int, Array] = field(default_factory=dict)
    culled: set[int] = field(default_factory=set)
    landmarks: dict[int, int] = field(default_factory=dict)
    """landmark -> state"""
    results: list[_engine.TrackingResult] = field(default_factory=list)
    wall_ms: list[float] = field(default_factory=list)
    digest: "hashlib._Hash" = field(default_factory=hashlib.sha256)

    def step(
        self, image: npt.NDArray[np.uint8], objects: MaskObjects, right: npt.NDArray[np.uint8] | None = None
    ) -> None:
        """Track the next frame; every object counts as standing."""
        index = len(self.results)
        track_image, ids, categories = objects.next_frame(index)
        states = np.full(len(ids), NON_MOVING, np.uint8)
        start = time.perf_counter()
        self.engine.begin_frame((index + 1) * FRAME_NS, image, right)
        result = self.engine.finish_frame(track_image, ids, categories, states, True)
        self.wall_ms.append((time.perf_counter() - start) * 1e3)
        self.results.append(result)
        if result.state == TRACKING:
            self.relative[index] = (result.reference_keyframe_id, result.camera_from_reference)
            self.digest.update(result.map_from_camera.tobytes())
        self._take()

    def finish(self) -> None:
        """The end of the input."""
        self.engine.flush()
        self._take()

    def centers(self) -> tuple[list[int], Array]:
        """Indices of the frames with a pose, and their camera centres (N, 3) in the final map."""
        indices = sorted(self.relative)
        poses = (self.relative[index] for index in indices)
        centers = [(self.keyframes[reference] @ np.linalg.inv(pose))[:3, 3] for reference, pose in poses]
        return indices, np.array(centers).reshape(-1, 3)

    def ate_m(self, true_centers_m: Array, alignment: Alignment = Alignment.SIM3) -> float:
        """Root mean square error of all frames with a pose after the best similarity (Umeyama 1991)."""
        indices, centers = self.centers()
        truth = true_centers_m[indices]
        aligned = align(centers, truth, alignment).points(centers)
        return float(np.sqrt(((aligned - truth) ** 2).sum(axis=1).mean()))

    def scale_error(self, true_centers_m: Array) -> float:
        """By how much the truth is longer than the map, as a share of it, in the best similarity."""
        indices, centers = self.centers()
        return float(align(centers, true_centers_m[indices], Alignment.SIM3).scale) - 1.0

    def initialized_at(self) -> int:
        """Index of the first frame with a pose of its own; -1 when there is none."""
        return next((index for index, result in enumerate(self.results) if result.state == TRACKING), -1)

    def tracked_share(self) -> float:
        """Share of the frames since initialisation that were tracked."""
        after = self.results[max(self.initialized_at(), 0) :]
        return sum(result.state == TRACKING for result in after) / len(after)

    def _take(self) -> None:
        update = self.engine.take_map_update()
        for name in sorted(update):
            self.digest.update(update[name].tobytes())
        for row, number in enumerate(update["keyframe_id"].tolist()):
            self.keyframes[number] = matrix_from_pose(update["keyframe_pose"][row])
            if update["keyframe_culled"][row]:
                self.culled.add(number)
        self.landmarks.update(zip(update["landmark_id"].tolist(), update["landmark_state"].tolist(), strict=True))
        for number in update["removed_landmark_id"].tolist():
            del self.landmarks[number]
        for row, timestamp_ns in enumerate(update["frame_timestamp_ns"].tolist()):
            reference = int(update["frame_reference_keyframe_id"][row])
            pose = matrix_from_pose(update["frame_camera_from_reference"][row])
            self.relative[timestamp_ns // FRAME_NS - 1] = (reference, pose)


def run_kitti(
    sequence: Path,
    options: _engine.EngineOptions,
    *,
    images: str = "image_0",
    frames: int | None = None,
    stereo: bool = False,
) -> EngineRun:
    """Run a folder in KITTI's layout with `instances/` beside the images; `stereo`: `image_1` too."""
    lines = [line.split() for line in (sequence / "calib.txt").read_text().splitlines()]
    projections = {words[0].rstrip(":"): np.array(words[1:], float).reshape(3, 4) for words in lines}
    p = projections["P0"]
    baseline_m = float(-projections["P1"][0, 3] / p[0, 0]) if stereo else 0.0
    paths = sorted((sequence / images).iterdir())[:frames]
    objects = MaskObjects(sequence / "instances", [path.stem for path in paths])
    run: EngineRun | None = None
    for path in paths:
        image = _grey(path)
        if run is None:
            height, width = image.shape
            camera = _engine.CameraModel(width, height, p[0, 0], p[1, 1], p[0, 2], p[1, 2], [], baseline_m)
            run = EngineRun(_engine.Engine(camera, options))
        run.step(image, objects, _grey(sequence / "image_1" / path.name) if stereo else None)
    if run is None:
        raise FileNotFoundError(f"{sequence / images}: no images")
    run.finish()
    return run


def _grey(path: Path) -> npt.NDArray[np.uint8]:
    return np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), np.uint8)


def true_centers_m(poses: Path) -> Array:
    """Camera centres (N, 3) of a KITTI pose file."""
    return np.loadtxt(poses).reshape(-1, 3, 4)[:, :, 3]
