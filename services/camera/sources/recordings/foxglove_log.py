# SPDX-License-Identifier: Apache-2.0
"""MCAP files with Foxglove's messages as protobuf: RawImage, CompressedImage, CameraCalibration, PoseInFrame."""

from contextlib import AbstractContextManager
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, NamedTuple

import numpy as np
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from mcap.reader import make_reader

from services.camera.sources.recordings.message_log import (
    CameraInfo,
    CompressedPixels,
    Kind,
    LoggedMessage,
    LoggedPose,
    LoggedTopic,
    RawPixels,
    StaticTransform,
    damage_refused,
)
from services.runtime.errors import InputError


class _Known(NamedTuple):
    """A message's type, and what the camera makes of it."""

    kind: Kind
    message: Any


_KNOWN: Final = MappingProxyType({
    "foxglove.RawImage": _Known("image", RawImage),
    "foxglove.CompressedImage": _Known("image", CompressedImage),
    "foxglove.CameraCalibration": _Known("info", CameraCalibration),
    "foxglove.PoseInFrame": _Known("pose", PoseInFrame),
    "foxglove.FrameTransform": _Known("pose", FrameTransform),
})  # fmt: skip


class FoxgloveLog:
    """An MCAP file, open, its index read. See `MessageLog`."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._stream = path.open("rb")
        try:
            with self._damage_refused():
                self._reader = make_reader(self._stream, validate_crcs=True)
                summary = self._reader.get_summary()
                if summary is None:
                    raise InputError(f"{path}: no index, expected a whole MCAP file")
        except BaseException:
            self._stream.close()
            raise
        counts = summary.statistics.channel_message_counts if summary.statistics else {}
        self._types: dict[str, str] = {}
        self._counts: dict[str, int] = {}
        for channel in summary.channels.values():
            schema = summary.schemas.get(channel.schema_id)
            if channel.message_encoding == "protobuf" and schema is not None and schema.name in _KNOWN:
                self._types[channel.topic] = schema.name
                self._counts[channel.topic] = self._counts.get(channel.topic, 0) + counts.get(channel.id, 0)

    @property
    def name(self) -> str:
        return f"MCAP {self._path.name}"

    @property
    def topics(self) -> list[LoggedTopic]:
        return [
            LoggedTopic(topic, _KNOWN[type_name].kind, type_name, self._counts[topic])
            for topic, type_name in sorted(self._types.items())
        ]

    def index(self, topic: str) -> list[LoggedMessage]:
        places: list[LoggedMessage] = []
        with self._damage_refused():
            for _, _, record in self._reader.iter_messages(topics=[topic]):
                repeats = bool(places) and places[-1].recorded_ns == record.log_time
                number = places[-1].number + 1 if repeats else 0
                stamp_ns = self._parsed(topic, record.data).timestamp.ToNanoseconds()
                places.append(LoggedMessage(stamp_ns or record.log_time, record.log_time, number))
        return places

    def image(self, topic: str, place: LoggedMessage) -> RawPixels | CompressedPixels:
        message = self._message(topic, place)
        data = np.frombuffer(message.data, dtype=np.uint8)
        if isinstance(message, CompressedImage):
            return CompressedPixels(message.frame_id, message.format, data)
        return RawPixels(message.frame_id, message.width, message.height, message.encoding, message.step, data)

    def info(self, topic: str, place: LoggedMessage) -> CameraInfo:
        message = self._message(topic, place)
        if len(message.K) != 9:
            raise InputError(f"{self.name} {topic}: K of {len(message.K)} numbers, expected 9")
        intrinsics = np.array(message.K).reshape(3, 3)
        projection = np.hstack((intrinsics, np.zeros((3, 1))))
        if len(message.P) == 12:
            projection = np.array(message.P).reshape(3, 4)
        return CameraInfo(
            message.width, message.height, message.distortion_model, tuple(message.D), intrinsics, projection
        )

    def pose(self, topic: str, place: LoggedMessage) -> LoggedPose:
        message = self._message(topic, place)
        if isinstance(message, FrameTransform):
            child, position, orientation = message.child_frame_id, message.translation, message.rotation
        else:
            child, position, orientation = "", message.pose.position, message.pose.orientation
        quaternion = (orientation.x, orientation.y, orientation.z, orientation.w)
        return LoggedPose(child, np.array([position.x, position.y, position.z, *quaternion]))

    def static_transforms(self) -> list[StaticTransform]:
        """None: Foxglove's transforms do not say which of them stay."""
        return []

    def close(self) -> None:
        self._stream.close()

    def _message(self, topic: str, place: LoggedMessage) -> Any:
        with self._damage_refused():
            at = self._reader.iter_messages([topic], starting_at=place.recorded_ns, ending_at=place.recorded_ns)
            _, _, record = next(islice(at, place.number, None))
            return self._parsed(topic, record.data)

    def _parsed(self, topic: str, data: bytes) -> Any:
        message = _KNOWN[self._types[topic]].message()
        message.ParseFromString(data)
        return message

    def _damage_refused(self) -> AbstractContextManager[None]:
        return damage_refused(str(self._path), "a whole MCAP file")
