from schemas.proto.kinemap import label_image_pb2 as _label_image_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class FrameManifest(_message.Message):
    __slots__ = ("version", "timestamp_ns", "source", "frame_name", "topics", "frame_count", "rate_hz")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    SOURCE_FIELD_NUMBER: _ClassVar[int]
    FRAME_NAME_FIELD_NUMBER: _ClassVar[int]
    TOPICS_FIELD_NUMBER: _ClassVar[int]
    FRAME_COUNT_FIELD_NUMBER: _ClassVar[int]
    RATE_HZ_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    source: str
    frame_name: str
    topics: _containers.RepeatedScalarFieldContainer[str]
    frame_count: int
    rate_hz: float
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., source: _Optional[str] = ..., frame_name: _Optional[str] = ..., topics: _Optional[_Iterable[str]] = ..., frame_count: _Optional[int] = ..., rate_hz: _Optional[float] = ...) -> None: ...

class EndOfInput(_message.Message):
    __slots__ = ("version", "timestamp_ns", "frame_count")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    FRAME_COUNT_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    frame_count: int
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., frame_count: _Optional[int] = ...) -> None: ...

class TrueObject(_message.Message):
    __slots__ = ("instance_id", "category", "moving", "velocity_m_s", "position_m", "box_px", "heading_rad", "size_m")
    INSTANCE_ID_FIELD_NUMBER: _ClassVar[int]
    CATEGORY_FIELD_NUMBER: _ClassVar[int]
    MOVING_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_M_S_FIELD_NUMBER: _ClassVar[int]
    POSITION_M_FIELD_NUMBER: _ClassVar[int]
    BOX_PX_FIELD_NUMBER: _ClassVar[int]
    HEADING_RAD_FIELD_NUMBER: _ClassVar[int]
    SIZE_M_FIELD_NUMBER: _ClassVar[int]
    instance_id: int
    category: str
    moving: bool
    velocity_m_s: _containers.RepeatedScalarFieldContainer[float]
    position_m: _containers.RepeatedScalarFieldContainer[float]
    box_px: _containers.RepeatedScalarFieldContainer[float]
    heading_rad: float
    size_m: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, instance_id: _Optional[int] = ..., category: _Optional[str] = ..., moving: _Optional[bool] = ..., velocity_m_s: _Optional[_Iterable[float]] = ..., position_m: _Optional[_Iterable[float]] = ..., box_px: _Optional[_Iterable[float]] = ..., heading_rad: _Optional[float] = ..., size_m: _Optional[_Iterable[float]] = ...) -> None: ...

class TrueInstances(_message.Message):
    __slots__ = ("version", "timestamp_ns", "labels", "objects")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    LABELS_FIELD_NUMBER: _ClassVar[int]
    OBJECTS_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    labels: _label_image_pb2.LabelImage
    objects: _containers.RepeatedCompositeFieldContainer[TrueObject]
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., labels: _Optional[_Union[_label_image_pb2.LabelImage, _Mapping]] = ..., objects: _Optional[_Iterable[_Union[TrueObject, _Mapping]]] = ...) -> None: ...
