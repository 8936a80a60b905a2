from schemas.proto.kinemap import label_image_pb2 as _label_image_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class Instance(_message.Message):
    __slots__ = ("instance_id", "category", "score", "box_px")
    INSTANCE_ID_FIELD_NUMBER: _ClassVar[int]
    CATEGORY_FIELD_NUMBER: _ClassVar[int]
    SCORE_FIELD_NUMBER: _ClassVar[int]
    BOX_PX_FIELD_NUMBER: _ClassVar[int]
    instance_id: int
    category: str
    score: float
    box_px: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, instance_id: _Optional[int] = ..., category: _Optional[str] = ..., score: _Optional[float] = ..., box_px: _Optional[_Iterable[float]] = ...) -> None: ...

class Instances(_message.Message):
    __slots__ = ("version", "timestamp_ns", "skipped", "labels", "instances")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    SKIPPED_FIELD_NUMBER: _ClassVar[int]
    LABELS_FIELD_NUMBER: _ClassVar[int]
    INSTANCES_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    skipped: bool
    labels: _label_image_pb2.LabelImage
    instances: _containers.RepeatedCompositeFieldContainer[Instance]
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., skipped: _Optional[bool] = ..., labels: _Optional[_Union[_label_image_pb2.LabelImage, _Mapping]] = ..., instances: _Optional[_Iterable[_Union[Instance, _Mapping]]] = ...) -> None: ...
