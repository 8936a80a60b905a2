# SPDX-License-Identifier: Apache-2.0
"""The one table of topics: who sends what to whom, how often, and what happens when a queue is full.

A topic's key expression on the bus is `kinemap/<robot>/<key>`, with `/<service>` behind it where every service sends
its own. tests/unit/schemas holds the services against this table.
"""

from dataclasses import dataclass
from enum import Enum

from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from google.protobuf.message import Message

from schemas.proto.kinemap import (
    camera_pb2,
    control_pb2,
    density_pb2,
    instances_pb2,
    mapped_objects_pb2,
    motion_pb2,
    objects_pb2,
    slam_pb2,
)

SCHEMA_VERSION = 1
"""In every own message; a receiver refuses another one."""


class WhenFull(Enum):
    """What a subscriber's full queue does in `realtime`; in `lossless` the window of frames bounds every queue."""

    DROP_OLDEST = "drop_oldest"
    KEEP_ALL = "keep_all"


@dataclass(frozen=True)
class Topic:
    """One row of the table."""

    key: str
    message: type[Message]
    producer: str
    consumers: tuple[str, ...]
    per_frame: bool
    """sent once for every frame: always, or (camera topics) when the frame's manifest lists it"""
    recorded: bool
    queue_depth: int
    when_full: WhenFull

    def __str__(self) -> str:
        return self.key


def _frame_topic(key: str, message: type[Message], producer: str, *consumers: str, depth: int = 1) -> Topic:
    return Topic(key, message, producer, (*consumers, "recorder"), True, True, depth, WhenFull.DROP_OLDEST)


MANIFEST = _frame_topic(
    "camera/manifest", camera_pb2.FrameManifest, "camera", "segmenter", "motion", "tracker", "slam", "mapstore"
)
CALIBRATION = _frame_topic("camera/calibration", CameraCalibration, "camera", "motion", "slam")
CALIBRATION_RIGHT = _frame_topic("camera/calibration_right", CameraCalibration, "camera", "slam")
IMAGE = _frame_topic("camera/image", RawImage, "camera", "segmenter", "motion", "slam")
IMAGE_RIGHT = _frame_topic("camera/image_right", RawImage, "camera", "slam")
DEPTH = _frame_topic("camera/depth", RawImage, "camera", "slam")
TRUE_POSE = _frame_topic("truth/pose", PoseInFrame, "camera")
TRUE_INSTANCES = _frame_topic("truth/instances", camera_pb2.TrueInstances, "camera", "segmenter")
INSTANCES = _frame_topic("segmenter/instances", instances_pb2.Instances, "segmenter", "motion")
EGO_MOTION = _frame_topic("motion/ego_motion", motion_pb2.EgoMotion, "motion")
INSTANCE_MOTIONS = _frame_topic("motion/instances", motion_pb2.InstanceMotions, "motion", "tracker")
MOVING_MASK = _frame_topic("motion/moving_mask", RawImage, "motion")
OBJECTS = _frame_topic("tracker/objects", objects_pb2.Objects, "tracker", "slam")
TRACKED_FRAME = _frame_topic("slam/tracked_frame", slam_pb2.TrackedFrame, "slam", "mapstore", "cli", depth=64)
MAP_UPDATE = _frame_topic("slam/map_update", slam_pb2.MapUpdate, "slam", "mapstore", depth=64)
DENSITY = _frame_topic("mapstore/density", density_pb2.Density, "mapstore", "cli")
MAPPED_OBJECTS = _frame_topic("slam/objects", mapped_objects_pb2.MappedObjects, "slam", "mapstore", depth=64)
POSE = Topic("slam/pose", PoseInFrame, "slam", ("recorder",), False, True, 1, WhenFull.DROP_OLDEST)
END = Topic(
    "camera/end",
    camera_pb2.EndOfInput,
    "camera",
    ("segmenter", "motion", "tracker", "slam", "mapstore", "recorder"),
    False,
    True,
    1,
    WhenFull.KEEP_ALL,
)
ANSWER = Topic("answer", control_pb2.FrameAnswer, "*", ("camera",), False, False, 64, WhenFull.KEEP_ALL)
HEARTBEAT = Topic("heartbeat", control_pb2.Heartbeat, "*", ("cli",), False, False, 64, WhenFull.DROP_OLDEST)

TOPICS: tuple[Topic, ...] = (
    MANIFEST,
    CALIBRATION,
    CALIBRATION_RIGHT,
    IMAGE,
    IMAGE_RIGHT,
    DEPTH,
    TRUE_POSE,
    TRUE_INSTANCES,
    INSTANCES,
    EGO_MOTION,
    INSTANCE_MOTIONS,
    MOVING_MASK,
    OBJECTS,
    TRACKED_FRAME,
    MAP_UPDATE,
    DENSITY,
    MAPPED_OBJECTS,
    POSE,
    END,
    ANSWER,
    HEARTBEAT,
)
BY_KEY: dict[str, Topic] = {topic.key: topic for topic in TOPICS}
ANSWERING_SERVICES = ("slam", "mapstore", "recorder")
"""The services whose answers to frame n - W let the camera send frame n (lossless)."""
