# SPDX-License-Identifier: Apache-2.0
"""A drive along a street as slam would report it: a frame and a map update at a time, every number from one seed."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from schemas.records import Density, DensityLevel, MapUpdate, MaskSource, MotionState, TrackedFrame, TrackingState
from services.mapstore.map_state import MapState
from services.mapstore.map_view import MapView

FRAME_NS = 100_000_000
LOOKING_ALONG_X = (-0.5, 0.5, -0.5, 0.5)
"""map_from_camera of a camera that looks along the map's x axis, z up"""
NO_DENSITY = Density(0, (1.0, 2.0, 3.0), 10.0, 30.0, 0, 0, 0, DensityLevel.UNKNOWN, True)
PASSING_CAR = 7
PARKED_CAR = 8


def keyframe_id(frame: int) -> int:
    return (1 << 32) + frame


def tracked(frame: int, keyframe: int, offset_m: float = 0.0, **changes: object) -> TrackedFrame:
    """The camera `offset_m` ahead of its reference keyframe, which stands at x = 1 m a frame."""
    pose = np.array([keyframe + offset_m, 0.0, 0.0, *LOOKING_ALONG_X])
    relative = np.array([0.0, 0.0, -offset_m, 0.0, 0.0, 0.0, 1.0])
    plain = TrackedFrame(
        timestamp_ns=frame * FRAME_NS,
        state=TrackingState.TRACKING,
        reason="",
        map_id=1,
        map_from_camera=pose,
        covariance=None,
        reference_keyframe_id=keyframe_id(keyframe),
        camera_from_reference=relative,
        features=2000,
        tracked_landmarks=300,
        keyframe_inserted=offset_m == 0.0,
        masks=MaskSource.FRESH,
        metric_scale=True,
        handling="moving",
    )
    return replace(plain, **changes)


def waiting(frame: int) -> TrackedFrame:
    """A frame before initialisation."""
    return tracked(
        frame,
        0,
        state=TrackingState.INITIALIZING,
        reason="too little parallax",
        map_from_camera=None,
        camera_from_reference=None,
        reference_keyframe_id=-1,
    )


def landmarks(frame: int, keyframe: int, ids: np.ndarray, position: np.ndarray, **columns: object) -> MapUpdate:
    """Landmarks in a keyframe's camera frame; static ones of no object unless `columns` says otherwise."""
    count = len(ids)
    update = MapUpdate(
        timestamp_ns=frame * FRAME_NS,
        map_id=1,
        metric_scale=True,
        landmark_id=np.asarray(ids, np.int64),
        landmark_anchor_id=np.full(count, keyframe_id(keyframe)),
        landmark_position=np.asarray(position, np.float32).reshape(-1, 3),
        landmark_state=np.zeros(count, np.uint8),
        landmark_category=np.full(count, -1, np.int32),
        landmark_object_id=np.zeros(count, np.uint32),
        landmark_first_seen_ns=np.full(count, frame * FRAME_NS),
        landmark_last_seen_ns=np.full(count, frame * FRAME_NS),
        landmark_valid_until_ns=np.full(count, -1),
    )
    names = {name: f"landmark_{name}" for name in columns}
    return replace(
        update,
        **{
            names[name]: np.broadcast_to(np.asarray(value), count).astype(getattr(update, names[name]).dtype)
            for name, value in columns.items()
        },
    )


def with_keyframes(update: MapUpdate, *frames: int, scale: float = 1.0, y: float = 0.0, culled: int = 0) -> MapUpdate:
    """The same update with keyframes at x = frame, y, 0."""
    count = len(frames)
    poses = np.array([[frame, y, 0.0, *LOOKING_ALONG_X, scale] for frame in frames]).reshape(-1, 8)
    return replace(
        update,
        keyframe_id=np.array([keyframe_id(frame) for frame in frames], np.int64),
        keyframe_timestamp_ns=np.array(frames, np.int64) * FRAME_NS,
        keyframe_map_id=np.ones(count, np.int64),
        keyframe_pose=poses,
        keyframe_culled=np.full(count, culled, np.uint8),
        keyframe_parent_id=np.full(count, -1, np.int64),
    )


def drive(frames: int, points: int = 40, every: int = 5) -> Iterator[tuple[TrackedFrame, MapUpdate]]:
    """A keyframe every `every` frames with houses at the sides, a parked car, and a car passing on the left."""
    rng = np.random.default_rng(11)
    next_id = 1 << 32
    for frame in range(frames):
        keyframe = frame - frame % every
        update = MapUpdate(timestamp_ns=frame * FRAME_NS, map_id=1, metric_scale=True)
        if frame == keyframe:
            ids = next_id + np.arange(points)
            next_id += points
            position = rng.uniform((-8, -3, 4), (8, 1, 25), (points, 3))
            state = np.full(points, MotionState.STATIC)
            number = np.zeros(points)
            state[:12], number[:12] = MotionState.MOVING, PASSING_CAR
            position[:12] = rng.uniform((-4, 0, 8), (-2, 1, 12), (12, 3))
            state[12:18], number[12:18] = MotionState.NON_MOVING, PARKED_CAR
            category = np.where(number > 0, 3, -1)
            update = with_keyframes(
                landmarks(frame, keyframe, ids, position, state=state, object_id=number, category=category), keyframe
            )
        yield tracked(frame, keyframe, float(frame - keyframe)), update


def state_of(frames: int) -> MapState:
    """The map after a drive."""
    state = MapState()
    state.session = "drive"
    for sequence, (frame, update) in enumerate(drive(frames)):
        state.add_frame(sequence, frame)
        state.apply(update)
    return state


def view_of(frames: int) -> MapView:
    """The same, to look at."""
    return state_of(frames).view()
