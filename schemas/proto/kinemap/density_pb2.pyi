from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class DensityLevel(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    UNKNOWN: _ClassVar[DensityLevel]
    LOW: _ClassVar[DensityLevel]
    HIGH: _ClassVar[DensityLevel]
UNKNOWN: DensityLevel
LOW: DensityLevel
HIGH: DensityLevel

class Density(_message.Message):
    __slots__ = ("version", "timestamp_ns", "position", "radius", "window_s", "moving_points", "moving_objects", "observed_points", "level", "metric_scale")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    RADIUS_FIELD_NUMBER: _ClassVar[int]
    WINDOW_S_FIELD_NUMBER: _ClassVar[int]
    MOVING_POINTS_FIELD_NUMBER: _ClassVar[int]
    MOVING_OBJECTS_FIELD_NUMBER: _ClassVar[int]
    OBSERVED_POINTS_FIELD_NUMBER: _ClassVar[int]
    LEVEL_FIELD_NUMBER: _ClassVar[int]
    METRIC_SCALE_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    position: _containers.RepeatedScalarFieldContainer[float]
    radius: float
    window_s: float
    moving_points: int
    moving_objects: int
    observed_points: int
    level: DensityLevel
    metric_scale: bool
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., position: _Optional[_Iterable[float]] = ..., radius: _Optional[float] = ..., window_s: _Optional[float] = ..., moving_points: _Optional[int] = ..., moving_objects: _Optional[int] = ..., observed_points: _Optional[int] = ..., level: _Optional[_Union[DensityLevel, str]] = ..., metric_scale: _Optional[bool] = ...) -> None: ...
