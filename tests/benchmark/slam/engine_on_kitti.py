# SPDX-License-Identifier: Apache-2.0
"""Run the engine alone, without a bus, on a KITTI odometry folder with instance masks, and print what it achieves.

python -m tests.benchmark.slam.engine_on_kitti SEQUENCE [--poses FILE] [--stage moving] [--frames N]
"""

import argparse
import hashlib
import json
import time
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from services.slam import _engine
from tests.benchmark.slam.mask_objects import MaskObjects

Array = npt.NDArray[np.float64]


def pose_matrix(pose: Array) -> Array:
    """4x4 matrix of tx ty tz qx qy qz qw (a scale after it is ignored)."""
    x, y, z, w = pose[3:7]
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, 3] = pose[:3]
    return matrix


def sim3_ate(estimate: Array, truth: Array) -> tuple[float, float]:
    """Root mean square error in metres after the best similarity (Umeyama 1991), and its scale. Both (N, 3)."""
    mean_e, mean_t = estimate.mean(axis=0), truth.mean(axis=0)
    e, t = estimate - mean_e, truth - mean_t
    u, d, vt = np.linalg.svd(t.T @ e / len(e))
    sign = np.diag([1, 1, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    rotation = u @ sign @ vt
    scale = np.trace(np.diag(d) @ sign) / (e**2).sum() * len(e)
    error = t - scale * e @ rotation.T
    return float(np.sqrt((error**2).sum(axis=1).mean())), float(scale)


class Run:
    """One pass over a sequence: frame poses relative to keyframes, and the keyframes' newest poses."""

    def __init__(self, camera: _engine.CameraModel, options: _engine.EngineOptions) -> None:
        self.engine = _engine.Engine(camera, options)
        self.relative: dict[int, tuple[int, Array]] = {}
        self.keyframes: dict[int, Array] = {}
        self.culled: set[int] = set()
        self.landmarks: dict[int, int] = {}
        self.digest = hashlib.sha256()
        self.states: list[int] = []
        self.tracked: list[int] = []
        self.reasons: list[str] = []
        self.wall_ms: list[float] = []
        self.stages: list[dict[str, float]] = []
        self.index_of_time: dict[int, int] = {}

    def step(self, index: int, timestamp_ns: int, image: npt.NDArray[np.uint8], objects: MaskObjects) -> None:
        track_image, ids, categories = objects.next_frame(index)
        states = np.full(len(ids), 1, np.uint8)
        start = time.perf_counter()
        self.engine.begin_frame(timestamp_ns, image)
        result = self.engine.finish_frame(track_image, ids, categories, states, True, None)
        self.wall_ms.append((time.perf_counter() - start) * 1e3)
        self.stages.append(result.stage_ms)
        self.index_of_time[timestamp_ns] = index
        self.states.append(result.state)
        self.tracked.append(result.tracked_landmarks)
        self.reasons.append(result.reason)
        if result.state == 1:
            self.relative[index] = (result.reference_keyframe_id, result.camera_from_reference)
            self.digest.update(result.map_from_camera.tobytes())
        self.take()

    def take(self) -> None:
        update = self.engine.take_map_update()
        for name in sorted(update):
            self.digest.update(update[name].tobytes())
        for row, number in enumerate(update["keyframe_id"].tolist()):
            self.keyframes[number] = pose_matrix(update["keyframe_pose"][row])
            if update["keyframe_culled"][row]:
                self.culled.add(number)
        self.landmarks.update(zip(update["landmark_id"].tolist(), update["landmark_state"].tolist(), strict=True))
        for number in update["removed_landmark_id"].tolist():
            del self.landmarks[number]
        for row, timestamp_ns in enumerate(update["frame_timestamp_ns"].tolist()):
            reference = int(update["frame_reference_keyframe_id"][row])
            pose = pose_matrix(update["frame_camera_from_reference"][row])
            self.relative[self.index_of_time[timestamp_ns]] = (reference, pose)

    def centers(self) -> tuple[list[int], Array]:
        """Indices of the frames with a pose, and their camera centres in the final map."""
        indices = sorted(self.relative)
        centers = [
            (self.keyframes[reference] @ np.linalg.inv(pose))[:3, 3]
            for reference, pose in (self.relative[index] for index in indices)
        ]
        return indices, np.array(centers).reshape(-1, 3)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence", type=Path)
    parser.add_argument("--poses", type=Path)
    parser.add_argument("--stage", choices=["base", "dynamic", "moving"], default="moving")
    parser.add_argument("--images", default="image_0")
    parser.add_argument("--frames", type=int)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--option", action="append", default=[], help="NAME=NUMBER of EngineOptions")
    arguments = parser.parse_args()

    line = next(line for line in (arguments.sequence / "calib.txt").read_text().splitlines() if line.startswith("P0"))
    projection = np.array(line.split()[1:], float).reshape(3, 4)
    paths = sorted((arguments.sequence / arguments.images).iterdir())[: arguments.frames]
    first = cv2.imread(str(paths[0]), cv2.IMREAD_GRAYSCALE)
    camera = _engine.CameraModel(
        first.shape[1], first.shape[0], projection[0, 0], projection[1, 1], projection[0, 2], projection[1, 2]
    )
    options = _engine.EngineOptions()
    options.stage = getattr(_engine.Stage, arguments.stage)
    options.seed = arguments.seed
    for assignment in arguments.option:
        name, value = assignment.split("=")
        setattr(options, name, type(getattr(options, name))(float(value)))
    run = Run(camera, options)
    objects = MaskObjects(arguments.sequence / "instances", [path.stem for path in paths])
    for index, path in enumerate(paths):
        image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
        run.step(index, 1_000_000_000 + index * 100_000_000, image, objects)
    run.engine.flush()
    run.take()

    indices, centers = run.centers()
    states = np.array(run.states)
    initialized = int(np.argmax(states > 0)) if (states > 0).any() else -1
    after = states[initialized:] if initialized >= 0 else states
    report: dict[str, object] = {
        "stage": arguments.stage,
        "frames": len(paths),
        "initialized_at": initialized,
        "with_pose": len(indices),
        "tracked_after_initialisation": round(float((after == 1).mean()), 4),
        "keyframes": len(run.keyframes),
        "culled": len(run.culled),
        "landmarks_by_state": {s: list(run.landmarks.values()).count(s) for s in sorted(set(run.landmarks.values()))},
        "ms_p50_p95": [round(float(np.percentile(run.wall_ms, p)), 1) for p in (50, 95)],
        "stage_ms_mean": {k: round(float(np.mean([s[k] for s in run.stages])), 1) for k in run.stages[0]},
        "digest": run.digest.hexdigest()[:16],
    }
    if arguments.poses and len(indices) > 3:
        truth = np.loadtxt(arguments.poses).reshape(-1, 3, 4)[indices, :, 3]
        ate, scale = sim3_ate(centers, truth)
        report["ate_m"], report["scale"] = round(ate, 3), round(scale, 3)
    print(json.dumps(report))
    for index, (state, reason) in enumerate(zip(run.states, run.reasons, strict=True)):
        if state != 1:
            print(f"  frame {index}: {reason}")


if __name__ == "__main__":
    main()
