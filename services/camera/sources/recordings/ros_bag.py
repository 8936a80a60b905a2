# SPDX-License-Identifier: Apache-2.0
"""Bags of ROS 1 (.bag) and ROS 2 (a folder with metadata.yaml, .db3, .mcap), read by rosbags: no ROS is installed."""

import struct
from contextlib import AbstractContextManager
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from schemas.codec.rigid import matrix_from_pose
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
from services.camera.sources.recordings.message_source import MessageSource
from services.camera.sources.recordings.message_topics import TopicOptions
from services.runtime.errors import InputError

_KINDS: Final = MappingProxyType[str, Kind]({
    "sensor_msgs/msg/Image": "image",
    "sensor_msgs/msg/CompressedImage": "image",
    "sensor_msgs/msg/CameraInfo": "info",
    "nav_msgs/msg/Odometry": "pose",
    "geometry_msgs/msg/PoseStamped": "pose",
    "geometry_msgs/msg/PoseWithCovarianceStamped": "pose",
    "geometry_msgs/msg/TransformStamped": "pose",
})  # fmt: skip
_STATIC_TRANSFORMS = "/tf_static"
_NS_PER_S = 1_000_000_000


class RosBag:
    """A bag, open. What a damaged one makes its reader raise comes out as one InputError. See `MessageLog`."""

    def __init__(self, path: Path) -> None:
        self._path = path
        with self._damage_refused():
            # ROS 2 bags before Iron do not hold the definitions of their messages.
            self._reader = AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))
            self._reader.open()
        self._connections: dict[str, list[Any]] = {}
        for connection in self._reader.connections:
            self._connections.setdefault(connection.topic, []).append(connection)

    @property
    def name(self) -> str:
        return f"bag {self._path.name}"

    @property
    def topics(self) -> list[LoggedTopic]:
        found = []
        for name, connections in sorted(self._connections.items()):
            kind = _KINDS.get(connections[0].msgtype)
            if kind is not None:
                count = sum(connection.msgcount for connection in connections)
                found.append(LoggedTopic(name, kind, connections[0].msgtype, count))
        return found

    def index(self, topic: str) -> list[LoggedMessage]:
        places: list[LoggedMessage] = []
        with self._damage_refused():
            for _, recorded_ns, data in self._reader.messages(self._connections[topic]):
                repeats = bool(places) and places[-1].recorded_ns == recorded_ns
                number = places[-1].number + 1 if repeats else 0
                places.append(LoggedMessage(self._stamp_ns(data) or recorded_ns, recorded_ns, number))
        return places

    def image(self, topic: str, place: LoggedMessage) -> RawPixels | CompressedPixels:
        message = self._message(topic, place)
        data = np.asarray(message.data, dtype=np.uint8)
        if hasattr(message, "format"):
            return CompressedPixels(message.header.frame_id, message.format, data)
        return RawPixels(
            message.header.frame_id,
            message.width,
            message.height,
            message.encoding,
            message.step,
            data,
            bool(message.is_bigendian),
        )

    def info(self, topic: str, place: LoggedMessage) -> CameraInfo:
        message = self._message(topic, place)
        # ROS 1 writes the matrices' names in capitals.
        distortion, intrinsics, projection = (
            getattr(message, name if hasattr(message, name) else name.upper()) for name in "dkp"
        )
        return CameraInfo(
            message.width,
            message.height,
            message.distortion_model,
            tuple(map(float, distortion)),
            np.array(intrinsics, dtype=np.float64).reshape(3, 3),
            np.array(projection, dtype=np.float64).reshape(3, 4),
        )

    def pose(self, topic: str, place: LoggedMessage) -> LoggedPose:
        message = self._message(topic, place)
        child = getattr(message, "child_frame_id", "")
        if hasattr(message, "transform"):
            return LoggedPose(child, _vector(message.transform.translation, message.transform.rotation))
        pose = message.pose.pose if hasattr(message.pose, "pose") else message.pose
        return LoggedPose(child, _vector(pose.position, pose.orientation))

    def static_transforms(self) -> list[StaticTransform]:
        if _STATIC_TRANSFORMS not in self._connections:
            return []
        found = []
        for place in self.index(_STATIC_TRANSFORMS):
            for one in self._message(_STATIC_TRANSFORMS, place).transforms:
                pose = _vector(one.transform.translation, one.transform.rotation)
                parent, child = one.header.frame_id, one.child_frame_id
                if not (np.isfinite(pose).all() and pose[3:].any()):
                    raise InputError(f"{self.name} {_STATIC_TRANSFORMS}: {child} in {parent} is at {pose.tolist()}, "
                                     "expected a position and a unit quaternion")  # fmt: skip
                found.append(StaticTransform(parent, child, matrix_from_pose(pose)))
        return found

    def close(self) -> None:
        if self._reader.stack is not None:
            self._reader.close()

    def _message(self, topic: str, place: LoggedMessage) -> Any:
        with self._damage_refused():
            at = self._reader.messages(self._connections[topic], place.recorded_ns, place.recorded_ns + 1)
            connection, _, data = next(islice(at, place.number, None))
            return self._reader.deserialize(data, connection.msgtype)

    def _stamp_ns(self, data: bytes) -> int:
        """The time of the std_msgs/Header that all messages of interest begin with, without parsing the rest."""
        if self._reader.is2:
            # CDR: four bytes of encapsulation, the second of them odd for little-endian.
            seconds, nanoseconds = struct.unpack_from("<iI" if data[1] & 1 else ">iI", data, 4)
        else:
            seconds, nanoseconds = struct.unpack_from("<II", data, 4)
        return int(seconds) * _NS_PER_S + int(nanoseconds)

    def _damage_refused(self) -> AbstractContextManager[None]:
        return damage_refused(f"bag {self._path}", "a whole bag of ROS 1 or 2")


def open_ros_bag(path: Path, topics: TopicOptions, *, calibration: Path | None = None) -> MessageSource:
    """The camera of a bag; calibration.toml in or beside the bag where it has no camera info. Raises InputError."""
    folder = path if path.is_dir() else path.parent
    beside = (path.with_suffix(".toml"), folder / "calibration.toml")
    return MessageSource(RosBag(path), topics, calibration=calibration, beside=beside)


def _vector(position: Any, orientation: Any) -> Any:
    return np.array(
        [position.x, position.y, position.z, orientation.x, orientation.y, orientation.z, orientation.w],
        dtype=np.float64,
    )
