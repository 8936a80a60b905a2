# SPDX-License-Identifier: Apache-2.0
"""What slam and the map store give."""

import numpy as np
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame

from schemas.codec.arrays import array_of, bytes_of, nanoseconds_of, vector_of
from schemas.codec.camera import pose_message, pose_vector
from schemas.proto.kinemap import density_pb2, slam_pb2
from schemas.records.density import Density, DensityLevel
from schemas.records.slam import MapUpdate, MaskSource, PoseInMap, TrackedFrame, TrackingState

_ARRAYS: dict[str, tuple[str, tuple[int, ...]]] = {
    "keyframe_id": ("<i8", ()),
    "keyframe_timestamp_ns": ("<i8", ()),
    "keyframe_map_id": ("<i8", ()),
    "keyframe_pose": ("<f8", (8,)),
    "keyframe_culled": ("u1", ()),
    "keyframe_parent_id": ("<i8", ()),
    "landmark_id": ("<i8", ()),
    "landmark_anchor_id": ("<i8", ()),
    "landmark_position": ("<f4", (3,)),
    "landmark_state": ("u1", ()),
    "landmark_category": ("<i4", ()),
    "landmark_object_id": ("<u4", ()),
    "landmark_first_seen_ns": ("<i8", ()),
    "landmark_last_seen_ns": ("<i8", ()),
    "landmark_valid_until_ns": ("<i8", ()),
    "removed_landmark_id": ("<i8", ()),
    "dense_keyframe_id": ("<i8", ()),
    "dense_keyframe_points": ("<i4", ()),
    "dense_point_position": ("<f4", (3,)),
    "dense_point_depth_sigma": ("<f4", ()),
    "dense_point_grey": ("u1", ()),
    "dense_point_state": ("u1", ()),
    "dense_point_category": ("<i2", ()),
    "dense_point_object_id": ("<u4", ()),
    "frame_timestamp_ns": ("<i8", ()),
    "frame_reference_keyframe_id": ("<i8", ()),
    "frame_camera_from_reference": ("<f8", (7,)),
}
MAP_ARRAYS = tuple(_ARRAYS)
"""The names of MapUpdate's arrays, in the schema's order."""


def tracked_frame_to_message(record: TrackedFrame) -> slam_pb2.TrackedFrame:
    def numbers(array: np.ndarray | None) -> list[float]:
        return [] if array is None else [float(value) for value in array.ravel()]

    return slam_pb2.TrackedFrame(
        timestamp_ns=record.timestamp_ns,
        state=slam_pb2.TrackingState.Name(record.state),
        reason=record.reason,
        map_id=record.map_id,
        map_from_camera=numbers(record.map_from_camera),
        covariance=numbers(record.covariance),
        reference_keyframe_id=record.reference_keyframe_id,
        camera_from_reference=numbers(record.camera_from_reference),
        features=record.features,
        tracked_landmarks=record.tracked_landmarks,
        keyframe_inserted=record.keyframe_inserted,
        masks=slam_pb2.MaskSource.Name(record.masks),
        metric_scale=record.metric_scale,
        handling=record.handling,
        moving_unplaced=record.moving_unplaced,
        stage_ms=[slam_pb2.StageTime(stage=stage, ms=ms) for stage, ms in record.stage_ms.items()],
        loop_closed=record.loop_closed,
        maps_merged=record.maps_merged,
    )


def tracked_frame_to_record(message: slam_pb2.TrackedFrame) -> TrackedFrame:
    def optional(name: str, size: int) -> np.ndarray | None:
        values = getattr(message, name)
        return vector_of(name, values, size) if len(values) else None

    covariance = optional("covariance", 36)
    return TrackedFrame(
        message.timestamp_ns,
        TrackingState(message.state),
        message.reason,
        message.map_id,
        optional("map_from_camera", 7),
        None if covariance is None else covariance.reshape(6, 6),
        message.reference_keyframe_id,
        optional("camera_from_reference", 7),
        message.features,
        message.tracked_landmarks,
        message.keyframe_inserted,
        MaskSource(message.masks),
        message.metric_scale,
        message.handling,
        message.moving_unplaced,
        {time.stage: time.ms for time in message.stage_ms},
        message.loop_closed,
        message.maps_merged,
    )


def map_update_to_message(record: MapUpdate) -> slam_pb2.MapUpdate:
    message = slam_pb2.MapUpdate(
        timestamp_ns=record.timestamp_ns, map_id=record.map_id, metric_scale=record.metric_scale
    )
    for name, (dtype, _) in _ARRAYS.items():
        setattr(message, name, bytes_of(getattr(record, name), dtype))
    return message


def map_update_to_record(message: slam_pb2.MapUpdate) -> MapUpdate:
    arrays = {name: array_of(name, getattr(message, name), *_flat(name)) for name in _ARRAYS}
    for prefix in ("keyframe_", "landmark_", "dense_keyframe_", "dense_point_", "frame_"):
        rows = {name: len(array) for name, array in arrays.items() if name.startswith(prefix)}
        if len(set(rows.values())) > 1:
            raise ValueError(f"{prefix}* arrays have {rows} rows, expected the same number in each")
    counts, points = arrays["dense_keyframe_points"], len(arrays["dense_point_grey"])
    if (counts < 0).any() or counts.sum(dtype=np.int64) != points:
        raise ValueError(f"dense_keyframe_points: expected numbers that add up to {points}, got {counts.tolist()}")
    return MapUpdate(message.timestamp_ns, message.map_id, message.metric_scale, **arrays)


def _flat(name: str) -> tuple[str, *tuple[int, ...]]:
    dtype, columns = _ARRAYS[name]
    return (dtype, *columns)


def pose_to_message(record: PoseInMap) -> PoseInFrame:
    return pose_message(record.timestamp_ns, "map", record.pose)


def pose_to_record(message: PoseInFrame) -> PoseInMap:
    return PoseInMap(nanoseconds_of(message.timestamp), pose_vector(message))


def density_to_message(record: Density) -> density_pb2.Density:
    return density_pb2.Density(
        timestamp_ns=record.timestamp_ns,
        position=record.position,
        radius=record.radius,
        window_s=record.window_s,
        moving_points=record.moving_points,
        moving_objects=record.moving_objects,
        observed_points=record.observed_points,
        level=density_pb2.DensityLevel.Name(record.level),
        metric_scale=record.metric_scale,
    )


def density_to_record(message: density_pb2.Density) -> Density:
    x, y, z = vector_of("position", message.position, 3).tolist()
    return Density(
        message.timestamp_ns,
        (x, y, z),
        message.radius,
        message.window_s,
        message.moving_points,
        message.moving_objects,
        message.observed_points,
        DensityLevel(message.level),
        message.metric_scale,
    )
