from schemas.proto.kinemap import label_image_pb2 as _label_image_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class MotionState(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    STATIC: _ClassVar[MotionState]
    NON_MOVING: _ClassVar[MotionState]
    MOVING: _ClassVar[MotionState]
    UNDECIDED: _ClassVar[MotionState]
    POTENTIALLY_DYNAMIC: _ClassVar[MotionState]
STATIC: MotionState
NON_MOVING: MotionState
MOVING: MotionState
UNDECIDED: MotionState
POTENTIALLY_DYNAMIC: MotionState

class ObjectTrack(_message.Message):
    __slots__ = ("object_id", "category", "score", "motion_state", "moving_probability", "box_px", "observed_frames")
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    CATEGORY_FIELD_NUMBER: _ClassVar[int]
    SCORE_FIELD_NUMBER: _ClassVar[int]
    MOTION_STATE_FIELD_NUMBER: _ClassVar[int]
    MOVING_PROBABILITY_FIELD_NUMBER: _ClassVar[int]
    BOX_PX_FIELD_NUMBER: _ClassVar[int]
    OBSERVED_FRAMES_FIELD_NUMBER: _ClassVar[int]
    object_id: int
    category: str
    score: float
    motion_state: MotionState
    moving_probability: float
    box_px: _containers.RepeatedScalarFieldContainer[float]
    observed_frames: int
    def __init__(self, object_id: _Optional[int] = ..., category: _Optional[str] = ..., score: _Optional[float] = ..., motion_state: _Optional[_Union[MotionState, str]] = ..., moving_probability: _Optional[float] = ..., box_px: _Optional[_Iterable[float]] = ..., observed_frames: _Optional[int] = ...) -> None: ...

class Objects(_message.Message):
    __slots__ = ("version", "timestamp_ns", "track_image", "objects", "masks_age_frames")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    TRACK_IMAGE_FIELD_NUMBER: _ClassVar[int]
    OBJECTS_FIELD_NUMBER: _ClassVar[int]
    MASKS_AGE_FRAMES_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    track_image: _label_image_pb2.LabelImage
    objects: _containers.RepeatedCompositeFieldContainer[ObjectTrack]
    masks_age_frames: int
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., track_image: _Optional[_Union[_label_image_pb2.LabelImage, _Mapping]] = ..., objects: _Optional[_Iterable[_Union[ObjectTrack, _Mapping]]] = ..., masks_age_frames: _Optional[int] = ...) -> None: ...
