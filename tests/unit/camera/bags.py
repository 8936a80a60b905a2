# SPDX-License-Identifier: Apache-2.0
"""Bags of ROS 1 and ROS 2, written as a robot would record them."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

NS_PER_S = 1_000_000_000
BagKind = str
KINDS = ("ros1", "sqlite", "mcap")


class Said(NamedTuple):
    """One message: its topic, when it was recorded, its type's name and the message."""

    topic: str
    recorded_ns: int
    type_name: str
    message: Any


@cache
def _store_of(kind: BagKind) -> Any:
    store = get_typestore(Stores.ROS1_NOETIC if kind == "ros1" else Stores.ROS2_HUMBLE)
    if kind == "ros1":
        # Noetic's store leaves tf2 out.
        definition = "geometry_msgs/TransformStamped[] transforms"
        store.register(get_types_from_msg(definition, "tf2_msgs/msg/TFMessage"))
    return store


class Ros:
    """Makes messages of one ROS generation and writes them to a bag."""

    def __init__(self, kind: BagKind) -> None:
        self.kind = kind
        self.store = _store_of(kind)

    def make(self, type_name: str, **fields: Any) -> Any:
        return self.store.types[type_name](**fields)

    def header(self, stamp_ns: int, frame_id: str) -> Any:
        stamp = self.make("builtin_interfaces/msg/Time", sec=stamp_ns // NS_PER_S, nanosec=stamp_ns % NS_PER_S)
        sequence = {"seq": 7} if self.kind == "ros1" else {}
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame_id, **sequence)

    def image(
        self, topic: str, stamp_ns: int, pixels: npt.NDArray[Any], encoding: str, *, late_ns: int = 0, padding: int = 0
    ) -> Said:
        """Pixels as they are, each row with `padding` bytes behind it."""
        rows = np.ascontiguousarray(pixels).view(np.uint8).reshape(pixels.shape[0], -1)
        rows = np.pad(rows, ((0, 0), (0, padding)), constant_values=77)
        type_name = "sensor_msgs/msg/Image"
        message = self.make(
            type_name,
            header=self.header(stamp_ns, "camera_optical"),
            height=pixels.shape[0],
            width=pixels.shape[1],
            encoding=encoding,
            is_bigendian=0,
            step=rows.shape[1],
            data=rows.ravel(),
        )
        return Said(topic, stamp_ns + late_ns, type_name, message)

    def compressed(self, topic: str, stamp_ns: int, pixels: npt.NDArray[Any]) -> Said:
        type_name = "sensor_msgs/msg/CompressedImage"
        message = self.make(
            type_name,
            header=self.header(stamp_ns, "camera_optical"),
            format="bgr8; png compressed bgr8",
            data=cv2.imencode(".png", pixels)[1].ravel(),
        )
        return Said(topic, stamp_ns, type_name, message)

    def info(self, topic: str, stamp_ns: int, size: tuple[int, int], **changed: Any) -> Said:
        type_name = "sensor_msgs/msg/CameraInfo"
        matrices = {
            "d": np.array(changed.get("d", (0.1, -0.2, 0.001, 0.002, 0.0))),
            "k": np.array((20.0, 0, 16, 0, 21, 12, 0, 0, 1)) * changed.get("focal", 1.0),
            "r": np.eye(3).ravel(),
            "p": np.array((18.0, 0, 15, 0, 0, 19, 11, 0, 0, 0, 1, 0)),
        }
        if self.kind == "ros1":
            matrices = {name.upper(): values for name, values in matrices.items()}
        region = self.make(
            "sensor_msgs/msg/RegionOfInterest", x_offset=0, y_offset=0, height=0, width=0, do_rectify=False
        )
        message = self.make(
            type_name,
            header=self.header(stamp_ns, "camera_optical"),
            width=size[0],
            height=size[1],
            distortion_model=changed.get("model", "plumb_bob"),
            binning_x=0,
            binning_y=0,
            roi=region,
            **matrices,
        )
        return Said(topic, stamp_ns, type_name, message)

    def odometry(self, topic: str, stamp_ns: int, pose: tuple[float, ...], child: str) -> Said:
        type_name = "nav_msgs/msg/Odometry"
        zero = self.make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        message = self.make(
            type_name,
            header=self.header(stamp_ns, "odom"),
            child_frame_id=child,
            pose=self.make("geometry_msgs/msg/PoseWithCovariance", pose=self._pose(pose), covariance=np.zeros(36)),
            twist=self.make(
                "geometry_msgs/msg/TwistWithCovariance",
                twist=self.make("geometry_msgs/msg/Twist", linear=zero, angular=zero),
                covariance=np.zeros(36),
            ),
        )
        return Said(topic, stamp_ns, type_name, message)

    def pose(self, topic: str, stamp_ns: int, pose: tuple[float, ...]) -> Said:
        type_name = "geometry_msgs/msg/PoseStamped"
        message = self.make(type_name, header=self.header(stamp_ns, "world"), pose=self._pose(pose))
        return Said(topic, stamp_ns, type_name, message)

    def static_transform(self, stamp_ns: int, parent: str, child: str, pose: tuple[float, ...]) -> Said:
        type_name = "tf2_msgs/msg/TFMessage"
        x, y, z, qx, qy, qz, qw = pose
        one = self.make(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(stamp_ns, parent),
            child_frame_id=child,
            transform=self.make(
                "geometry_msgs/msg/Transform",
                translation=self.make("geometry_msgs/msg/Vector3", x=x, y=y, z=z),
                rotation=self.make("geometry_msgs/msg/Quaternion", x=qx, y=qy, z=qz, w=qw),
            ),
        )
        return Said("/tf_static", stamp_ns, type_name, self.make(type_name, transforms=[one]))

    def _pose(self, pose: tuple[float, ...]) -> Any:
        x, y, z, qx, qy, qz, qw = pose
        return self.make(
            "geometry_msgs/msg/Pose",
            position=self.make("geometry_msgs/msg/Point", x=x, y=y, z=z),
            orientation=self.make("geometry_msgs/msg/Quaternion", x=qx, y=qy, z=qz, w=qw),
        )

    def write(self, folder: Path, messages: list[Said]) -> Path:
        """Write a bag `drive` into `folder`; its path as a user would name it."""
        if self.kind == "ros1":
            path = folder / "drive.bag"
            with Writer1(path) as writer:
                self._write_all(writer, messages, self.store.serialize_ros1)
            return path
        path = folder / f"drive_{self.kind}"
        plugin = StoragePlugin.MCAP if self.kind == "mcap" else StoragePlugin.SQLITE3
        with Writer2(path, version=9, storage_plugin=plugin) as writer:
            self._write_all(writer, messages, self.store.serialize_cdr)
        return path

    def _write_all(self, writer: Any, messages: list[Said], serialize: Callable[[Any, str], Any]) -> None:
        connections: dict[str, Any] = {}
        for said in messages:
            if said.topic not in connections:
                connections[said.topic] = writer.add_connection(said.topic, said.type_name, typestore=self.store)
            writer.write(connections[said.topic], said.recorded_ns, serialize(said.message, said.type_name))
