from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class TrackingState(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    INITIALIZING: _ClassVar[TrackingState]
    TRACKING: _ClassVar[TrackingState]
    LOST: _ClassVar[TrackingState]

class MaskSource(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    NO_MASKS: _ClassVar[MaskSource]
    FRESH: _ClassVar[MaskSource]
    CARRIED: _ClassVar[MaskSource]
INITIALIZING: TrackingState
TRACKING: TrackingState
LOST: TrackingState
NO_MASKS: MaskSource
FRESH: MaskSource
CARRIED: MaskSource

class StageTime(_message.Message):
    __slots__ = ("stage", "ms")
    STAGE_FIELD_NUMBER: _ClassVar[int]
    MS_FIELD_NUMBER: _ClassVar[int]
    stage: str
    ms: float
    def __init__(self, stage: _Optional[str] = ..., ms: _Optional[float] = ...) -> None: ...

class TrackedFrame(_message.Message):
    __slots__ = ("version", "timestamp_ns", "state", "reason", "map_id", "map_from_camera", "covariance", "reference_keyframe_id", "camera_from_reference", "features", "tracked_landmarks", "keyframe_inserted", "masks", "metric_scale", "handling", "moving_unplaced", "stage_ms", "loop_closed", "maps_merged")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    MAP_ID_FIELD_NUMBER: _ClassVar[int]
    MAP_FROM_CAMERA_FIELD_NUMBER: _ClassVar[int]
    COVARIANCE_FIELD_NUMBER: _ClassVar[int]
    REFERENCE_KEYFRAME_ID_FIELD_NUMBER: _ClassVar[int]
    CAMERA_FROM_REFERENCE_FIELD_NUMBER: _ClassVar[int]
    FEATURES_FIELD_NUMBER: _ClassVar[int]
    TRACKED_LANDMARKS_FIELD_NUMBER: _ClassVar[int]
    KEYFRAME_INSERTED_FIELD_NUMBER: _ClassVar[int]
    MASKS_FIELD_NUMBER: _ClassVar[int]
    METRIC_SCALE_FIELD_NUMBER: _ClassVar[int]
    HANDLING_FIELD_NUMBER: _ClassVar[int]
    MOVING_UNPLACED_FIELD_NUMBER: _ClassVar[int]
    STAGE_MS_FIELD_NUMBER: _ClassVar[int]
    LOOP_CLOSED_FIELD_NUMBER: _ClassVar[int]
    MAPS_MERGED_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    state: TrackingState
    reason: str
    map_id: int
    map_from_camera: _containers.RepeatedScalarFieldContainer[float]
    covariance: _containers.RepeatedScalarFieldContainer[float]
    reference_keyframe_id: int
    camera_from_reference: _containers.RepeatedScalarFieldContainer[float]
    features: int
    tracked_landmarks: int
    keyframe_inserted: bool
    masks: MaskSource
    metric_scale: bool
    handling: str
    moving_unplaced: int
    stage_ms: _containers.RepeatedCompositeFieldContainer[StageTime]
    loop_closed: bool
    maps_merged: bool
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., state: _Optional[_Union[TrackingState, str]] = ..., reason: _Optional[str] = ..., map_id: _Optional[int] = ..., map_from_camera: _Optional[_Iterable[float]] = ..., covariance: _Optional[_Iterable[float]] = ..., reference_keyframe_id: _Optional[int] = ..., camera_from_reference: _Optional[_Iterable[float]] = ..., features: _Optional[int] = ..., tracked_landmarks: _Optional[int] = ..., keyframe_inserted: _Optional[bool] = ..., masks: _Optional[_Union[MaskSource, str]] = ..., metric_scale: _Optional[bool] = ..., handling: _Optional[str] = ..., moving_unplaced: _Optional[int] = ..., stage_ms: _Optional[_Iterable[_Union[StageTime, _Mapping]]] = ..., loop_closed: _Optional[bool] = ..., maps_merged: _Optional[bool] = ...) -> None: ...

class MapUpdate(_message.Message):
    __slots__ = ("version", "timestamp_ns", "map_id", "metric_scale", "keyframe_id", "keyframe_timestamp_ns", "keyframe_map_id", "keyframe_pose", "keyframe_culled", "keyframe_parent_id", "landmark_id", "landmark_anchor_id", "landmark_position", "landmark_state", "landmark_category", "landmark_object_id", "landmark_first_seen_ns", "landmark_last_seen_ns", "landmark_valid_until_ns", "removed_landmark_id", "dense_keyframe_id", "dense_keyframe_points", "dense_point_position", "dense_point_depth_sigma", "dense_point_grey", "dense_point_state", "dense_point_category", "dense_point_object_id", "frame_timestamp_ns", "frame_reference_keyframe_id", "frame_camera_from_reference")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    MAP_ID_FIELD_NUMBER: _ClassVar[int]
    METRIC_SCALE_FIELD_NUMBER: _ClassVar[int]
    KEYFRAME_ID_FIELD_NUMBER: _ClassVar[int]
    KEYFRAME_TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    KEYFRAME_MAP_ID_FIELD_NUMBER: _ClassVar[int]
    KEYFRAME_POSE_FIELD_NUMBER: _ClassVar[int]
    KEYFRAME_CULLED_FIELD_NUMBER: _ClassVar[int]
    KEYFRAME_PARENT_ID_FIELD_NUMBER: _ClassVar[int]
    LANDMARK_ID_FIELD_NUMBER: _ClassVar[int]
    LANDMARK_ANCHOR_ID_FIELD_NUMBER: _ClassVar[int]
    LANDMARK_POSITION_FIELD_NUMBER: _ClassVar[int]
    LANDMARK_STATE_FIELD_NUMBER: _ClassVar[int]
    LANDMARK_CATEGORY_FIELD_NUMBER: _ClassVar[int]
    LANDMARK_OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    LANDMARK_FIRST_SEEN_NS_FIELD_NUMBER: _ClassVar[int]
    LANDMARK_LAST_SEEN_NS_FIELD_NUMBER: _ClassVar[int]
    LANDMARK_VALID_UNTIL_NS_FIELD_NUMBER: _ClassVar[int]
    REMOVED_LANDMARK_ID_FIELD_NUMBER: _ClassVar[int]
    DENSE_KEYFRAME_ID_FIELD_NUMBER: _ClassVar[int]
    DENSE_KEYFRAME_POINTS_FIELD_NUMBER: _ClassVar[int]
    DENSE_POINT_POSITION_FIELD_NUMBER: _ClassVar[int]
    DENSE_POINT_DEPTH_SIGMA_FIELD_NUMBER: _ClassVar[int]
    DENSE_POINT_GREY_FIELD_NUMBER: _ClassVar[int]
    DENSE_POINT_STATE_FIELD_NUMBER: _ClassVar[int]
    DENSE_POINT_CATEGORY_FIELD_NUMBER: _ClassVar[int]
    DENSE_POINT_OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    FRAME_TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    FRAME_REFERENCE_KEYFRAME_ID_FIELD_NUMBER: _ClassVar[int]
    FRAME_CAMERA_FROM_REFERENCE_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    map_id: int
    metric_scale: bool
    keyframe_id: bytes
    keyframe_timestamp_ns: bytes
    keyframe_map_id: bytes
    keyframe_pose: bytes
    keyframe_culled: bytes
    keyframe_parent_id: bytes
    landmark_id: bytes
    landmark_anchor_id: bytes
    landmark_position: bytes
    landmark_state: bytes
    landmark_category: bytes
    landmark_object_id: bytes
    landmark_first_seen_ns: bytes
    landmark_last_seen_ns: bytes
    landmark_valid_until_ns: bytes
    removed_landmark_id: bytes
    dense_keyframe_id: bytes
    dense_keyframe_points: bytes
    dense_point_position: bytes
    dense_point_depth_sigma: bytes
    dense_point_grey: bytes
    dense_point_state: bytes
    dense_point_category: bytes
    dense_point_object_id: bytes
    frame_timestamp_ns: bytes
    frame_reference_keyframe_id: bytes
    frame_camera_from_reference: bytes
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., map_id: _Optional[int] = ..., metric_scale: _Optional[bool] = ..., keyframe_id: _Optional[bytes] = ..., keyframe_timestamp_ns: _Optional[bytes] = ..., keyframe_map_id: _Optional[bytes] = ..., keyframe_pose: _Optional[bytes] = ..., keyframe_culled: _Optional[bytes] = ..., keyframe_parent_id: _Optional[bytes] = ..., landmark_id: _Optional[bytes] = ..., landmark_anchor_id: _Optional[bytes] = ..., landmark_position: _Optional[bytes] = ..., landmark_state: _Optional[bytes] = ..., landmark_category: _Optional[bytes] = ..., landmark_object_id: _Optional[bytes] = ..., landmark_first_seen_ns: _Optional[bytes] = ..., landmark_last_seen_ns: _Optional[bytes] = ..., landmark_valid_until_ns: _Optional[bytes] = ..., removed_landmark_id: _Optional[bytes] = ..., dense_keyframe_id: _Optional[bytes] = ..., dense_keyframe_points: _Optional[bytes] = ..., dense_point_position: _Optional[bytes] = ..., dense_point_depth_sigma: _Optional[bytes] = ..., dense_point_grey: _Optional[bytes] = ..., dense_point_state: _Optional[bytes] = ..., dense_point_category: _Optional[bytes] = ..., dense_point_object_id: _Optional[bytes] = ..., frame_timestamp_ns: _Optional[bytes] = ..., frame_reference_keyframe_id: _Optional[bytes] = ..., frame_camera_from_reference: _Optional[bytes] = ...) -> None: ...
