from schemas.proto.kinemap import objects_pb2 as _objects_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class MappedObject(_message.Message):
    __slots__ = ("object_id", "category", "motion_state", "position", "velocity", "heading_rad", "size", "position_sigma", "velocity_sigma", "by_depth")
    OBJECT_ID_FIELD_NUMBER: _ClassVar[int]
    CATEGORY_FIELD_NUMBER: _ClassVar[int]
    MOTION_STATE_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FIELD_NUMBER: _ClassVar[int]
    HEADING_RAD_FIELD_NUMBER: _ClassVar[int]
    SIZE_FIELD_NUMBER: _ClassVar[int]
    POSITION_SIGMA_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_SIGMA_FIELD_NUMBER: _ClassVar[int]
    BY_DEPTH_FIELD_NUMBER: _ClassVar[int]
    object_id: int
    category: str
    motion_state: _objects_pb2.MotionState
    position: _containers.RepeatedScalarFieldContainer[float]
    velocity: _containers.RepeatedScalarFieldContainer[float]
    heading_rad: float
    size: _containers.RepeatedScalarFieldContainer[float]
    position_sigma: float
    velocity_sigma: float
    by_depth: bool
    def __init__(self, object_id: _Optional[int] = ..., category: _Optional[str] = ..., motion_state: _Optional[_Union[_objects_pb2.MotionState, str]] = ..., position: _Optional[_Iterable[float]] = ..., velocity: _Optional[_Iterable[float]] = ..., heading_rad: _Optional[float] = ..., size: _Optional[_Iterable[float]] = ..., position_sigma: _Optional[float] = ..., velocity_sigma: _Optional[float] = ..., by_depth: _Optional[bool] = ...) -> None: ...

class MappedObjects(_message.Message):
    __slots__ = ("version", "timestamp_ns", "map_id", "metric_scale", "objects")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    MAP_ID_FIELD_NUMBER: _ClassVar[int]
    METRIC_SCALE_FIELD_NUMBER: _ClassVar[int]
    OBJECTS_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    map_id: int
    metric_scale: bool
    objects: _containers.RepeatedCompositeFieldContainer[MappedObject]
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., map_id: _Optional[int] = ..., metric_scale: _Optional[bool] = ..., objects: _Optional[_Iterable[_Union[MappedObject, _Mapping]]] = ...) -> None: ...
