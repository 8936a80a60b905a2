# SPDX-License-Identifier: Apache-2.0
"""Which codec a message type has, and the checks that hold for all of them."""

from collections.abc import Callable
from typing import Any, NamedTuple

from google.protobuf.message import DecodeError, Message

from schemas import topics
from schemas.codec import camera, control, motion, objects, slam
from schemas.errors import ProtocolError
from schemas.topics import SCHEMA_VERSION, Topic


class Codec(NamedTuple):
    """How one topic's message becomes a record and the other way round."""

    to_message: Callable[[Any], Message]
    to_record: Callable[[Any], Any]


_CODECS: dict[Topic, Codec] = {
    topics.MANIFEST: Codec(camera.manifest_to_message, camera.manifest_to_record),
    topics.CALIBRATION: Codec(camera.calibration_to_message, camera.calibration_to_record),
    topics.CALIBRATION_RIGHT: Codec(camera.calibration_to_message, camera.calibration_to_record),
    topics.IMAGE: Codec(camera.image_to_message, camera.image_to_record),
    topics.IMAGE_RIGHT: Codec(camera.image_to_message, camera.image_to_record),
    topics.DEPTH: Codec(camera.depth_to_message, camera.depth_to_record),
    topics.TRUE_POSE: Codec(camera.true_pose_to_message, camera.true_pose_to_record),
    topics.TRUE_INSTANCES: Codec(camera.true_instances_to_message, camera.true_instances_to_record),
    topics.END: Codec(camera.end_to_message, camera.end_to_record),
    topics.INSTANCES: Codec(objects.instances_to_message, objects.instances_to_record),
    topics.EGO_MOTION: Codec(motion.ego_motion_to_message, motion.ego_motion_to_record),
    topics.INSTANCE_MOTIONS: Codec(motion.instance_motions_to_message, motion.instance_motions_to_record),
    topics.MOVING_MASK: Codec(motion.moving_mask_to_message, motion.moving_mask_to_record),
    topics.OBJECTS: Codec(objects.objects_to_message, objects.objects_to_record),
    topics.TRACKED_FRAME: Codec(slam.tracked_frame_to_message, slam.tracked_frame_to_record),
    topics.MAP_UPDATE: Codec(slam.map_update_to_message, slam.map_update_to_record),
    topics.MAPPED_OBJECTS: Codec(objects.mapped_objects_to_message, objects.mapped_objects_to_record),
    topics.POSE: Codec(slam.pose_to_message, slam.pose_to_record),
    topics.DENSITY: Codec(slam.density_to_message, slam.density_to_record),
    topics.ANSWER: Codec(control.answer_to_message, control.answer_to_record),
    topics.HEARTBEAT: Codec(control.heartbeat_to_message, control.heartbeat_to_record),
}


def encode(topic: Topic, record: Any) -> bytes:
    """The bytes that go over the bus and into a recording: the same for the same record, every time."""
    message = _CODECS[topic].to_message(record)
    if "version" in message.DESCRIPTOR.fields_by_name:
        message.version = SCHEMA_VERSION  # type: ignore[attr-defined]
    return message.SerializeToString(deterministic=True)


def decode(topic: Topic, payload: bytes) -> Any:
    """The record in `payload`. Raises ProtocolError when it is cut off, of another version, or contradicts itself."""
    message = topic.message()
    try:
        message.ParseFromString(payload)
    except DecodeError as error:
        raise ProtocolError(f"{topic.key}: {len(payload)} bytes that are no {topic.message.DESCRIPTOR.name}") from error
    version = getattr(message, "version", SCHEMA_VERSION)
    if version != SCHEMA_VERSION:
        raise ProtocolError(f"{topic.key}: message version {version}, expected {SCHEMA_VERSION}")
    try:
        return _CODECS[topic].to_record(message)
    except (ValueError, IndexError, KeyError, TypeError) as error:
        raise ProtocolError(f"{topic.key}: {error}") from error
