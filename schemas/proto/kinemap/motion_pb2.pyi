from schemas.proto.kinemap import label_image_pb2 as _label_image_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class EgoMotion(_message.Message):
    __slots__ = ("version", "timestamp_ns", "previous_timestamp_ns", "valid", "reason", "rotation", "translation_direction", "inlier_ratio", "samples", "background_flow_px", "parallax_px")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    PREVIOUS_TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    VALID_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    ROTATION_FIELD_NUMBER: _ClassVar[int]
    TRANSLATION_DIRECTION_FIELD_NUMBER: _ClassVar[int]
    INLIER_RATIO_FIELD_NUMBER: _ClassVar[int]
    SAMPLES_FIELD_NUMBER: _ClassVar[int]
    BACKGROUND_FLOW_PX_FIELD_NUMBER: _ClassVar[int]
    PARALLAX_PX_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    previous_timestamp_ns: int
    valid: bool
    reason: str
    rotation: _containers.RepeatedScalarFieldContainer[float]
    translation_direction: _containers.RepeatedScalarFieldContainer[float]
    inlier_ratio: float
    samples: int
    background_flow_px: float
    parallax_px: float
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., previous_timestamp_ns: _Optional[int] = ..., valid: _Optional[bool] = ..., reason: _Optional[str] = ..., rotation: _Optional[_Iterable[float]] = ..., translation_direction: _Optional[_Iterable[float]] = ..., inlier_ratio: _Optional[float] = ..., samples: _Optional[int] = ..., background_flow_px: _Optional[float] = ..., parallax_px: _Optional[float] = ...) -> None: ...

class InstanceMotion(_message.Message):
    __slots__ = ("instance_id", "category", "score", "box_px", "moving_probability", "epipolar_residual_px", "residual_noise_px", "samples", "age_frames")
    INSTANCE_ID_FIELD_NUMBER: _ClassVar[int]
    CATEGORY_FIELD_NUMBER: _ClassVar[int]
    SCORE_FIELD_NUMBER: _ClassVar[int]
    BOX_PX_FIELD_NUMBER: _ClassVar[int]
    MOVING_PROBABILITY_FIELD_NUMBER: _ClassVar[int]
    EPIPOLAR_RESIDUAL_PX_FIELD_NUMBER: _ClassVar[int]
    RESIDUAL_NOISE_PX_FIELD_NUMBER: _ClassVar[int]
    SAMPLES_FIELD_NUMBER: _ClassVar[int]
    AGE_FRAMES_FIELD_NUMBER: _ClassVar[int]
    instance_id: int
    category: str
    score: float
    box_px: _containers.RepeatedScalarFieldContainer[float]
    moving_probability: float
    epipolar_residual_px: float
    residual_noise_px: float
    samples: int
    age_frames: int
    def __init__(self, instance_id: _Optional[int] = ..., category: _Optional[str] = ..., score: _Optional[float] = ..., box_px: _Optional[_Iterable[float]] = ..., moving_probability: _Optional[float] = ..., epipolar_residual_px: _Optional[float] = ..., residual_noise_px: _Optional[float] = ..., samples: _Optional[int] = ..., age_frames: _Optional[int] = ...) -> None: ...

class InstanceMotions(_message.Message):
    __slots__ = ("version", "timestamp_ns", "labels", "instances")
    VERSION_FIELD_NUMBER: _ClassVar[int]
    TIMESTAMP_NS_FIELD_NUMBER: _ClassVar[int]
    LABELS_FIELD_NUMBER: _ClassVar[int]
    INSTANCES_FIELD_NUMBER: _ClassVar[int]
    version: int
    timestamp_ns: int
    labels: _label_image_pb2.LabelImage
    instances: _containers.RepeatedCompositeFieldContainer[InstanceMotion]
    def __init__(self, version: _Optional[int] = ..., timestamp_ns: _Optional[int] = ..., labels: _Optional[_Union[_label_image_pb2.LabelImage, _Mapping]] = ..., instances: _Optional[_Iterable[_Union[InstanceMotion, _Mapping]]] = ...) -> None: ...
