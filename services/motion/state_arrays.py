# SPDX-License-Identifier: Apache-2.0
"""The state between two images as named arrays, exactly, so that a killed service goes on where it was."""

import numpy as np
import numpy.typing as npt

from schemas.records import Instance
from services.motion.mask_carrier import CarriedMasks
from services.motion.scene_motion import SceneMotionState
from services.motion.two_view import CameraMotion

Arrays = dict[str, npt.NDArray[np.generic]]


def arrays_of_state(state: SceneMotionState) -> Arrays:
    """Arrays that `state_of_arrays` makes the same state of. What is not known is an empty array."""
    instances = state.masks.instances
    motion = state.motion
    return {
        "timestamp_ns": np.array(state.timestamp_ns, np.int64),
        "pixels": state.pixels,
        "labels": state.masks.labels,
        "age_frames": np.array(state.masks.age_frames, np.int64),
        "instance_id": np.array([instance.instance_id for instance in instances], np.int64),
        "category": np.array([instance.category for instance in instances], np.str_),
        "score": np.array([instance.score for instance in instances], np.float64),
        "box_px": np.array([instance.box_px for instance in instances], np.float64).reshape(-1, 4),
        "rotation": np.empty(0) if motion is None else motion.rotation,
        "translation": np.empty(0) if motion is None else motion.translation,
        "ground_normal": np.empty(0) if state.ground_normal is None else state.ground_normal,
    }


def state_of_arrays(arrays: Arrays) -> SceneMotionState:
    """The state that `arrays_of_state` was given."""
    boxes = np.asarray(arrays["box_px"], np.float64)
    instances = tuple(
        Instance(int(instance_id), str(category), float(score), (float(x), float(y), float(width), float(height)))
        for instance_id, category, score, (x, y, width, height) in zip(
            np.asarray(arrays["instance_id"], np.int64),
            arrays["category"],
            np.asarray(arrays["score"], np.float64),
            boxes,
            strict=True,
        )
    )
    masks = CarriedMasks(np.asarray(arrays["labels"], np.uint32), instances, int(np.asarray(arrays["age_frames"])))
    rotation = np.asarray(arrays["rotation"], np.float64)
    normal = np.asarray(arrays["ground_normal"], np.float64)
    return SceneMotionState(
        timestamp_ns=int(np.asarray(arrays["timestamp_ns"])),
        pixels=np.asarray(arrays["pixels"], np.uint8),
        masks=masks,
        motion=CameraMotion(rotation, np.asarray(arrays["translation"], np.float64)) if rotation.size else None,
        ground_normal=normal if normal.size else None,
    )
