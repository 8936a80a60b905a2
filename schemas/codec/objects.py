# SPDX-License-Identifier: Apache-2.0
"""What the segmenter, the tracker and slam give: objects in one image, over time, and in the map."""

from collections.abc import Sequence

from schemas.codec.arrays import box_of, labels_to_array, labels_to_message
from schemas.errors import ProtocolError
from schemas.proto.kinemap import instances_pb2, mapped_objects_pb2, objects_pb2
from schemas.records.instances import Instance, Instances
from schemas.records.mapped_objects import MappedObject, MappedObjects
from schemas.records.objects import MotionState, Objects, ObjectTrack


def instances_to_message(record: Instances) -> instances_pb2.Instances:
    return instances_pb2.Instances(
        timestamp_ns=record.timestamp_ns,
        skipped=record.skipped,
        labels=labels_to_message(record.labels),
        instances=[
            instances_pb2.Instance(instance_id=i.instance_id, category=i.category, score=i.score, box_px=i.box_px)
            for i in record.instances
        ],
    )


def instances_to_record(message: instances_pb2.Instances) -> Instances:
    return Instances(
        message.timestamp_ns,
        labels_to_array(message.labels),
        tuple(Instance(i.instance_id, i.category, i.score, box_of(i.box_px)) for i in message.instances),
        message.skipped,
    )


def objects_to_message(record: Objects) -> objects_pb2.Objects:
    return objects_pb2.Objects(
        timestamp_ns=record.timestamp_ns,
        track_image=labels_to_message(record.track_image),
        masks_age_frames=record.masks_age_frames,
        objects=[
            objects_pb2.ObjectTrack(
                object_id=o.object_id,
                category=o.category,
                score=o.score,
                motion_state=objects_pb2.MotionState.Name(o.motion_state),
                moving_probability=o.moving_probability,
                box_px=o.box_px,
                observed_frames=o.observed_frames,
            )
            for o in record.objects
        ],
    )


def objects_to_record(message: objects_pb2.Objects) -> Objects:
    return Objects(
        message.timestamp_ns,
        labels_to_array(message.track_image),
        tuple(
            ObjectTrack(
                o.object_id,
                o.category,
                o.score,
                MotionState(o.motion_state),
                o.moving_probability,
                box_of(o.box_px),
                o.observed_frames,
            )
            for o in message.objects
        ),
        message.masks_age_frames,
    )


def mapped_objects_to_message(record: MappedObjects) -> mapped_objects_pb2.MappedObjects:
    return mapped_objects_pb2.MappedObjects(
        timestamp_ns=record.timestamp_ns,
        map_id=record.map_id,
        metric_scale=record.metric_scale,
        objects=[
            mapped_objects_pb2.MappedObject(
                object_id=o.object_id,
                category=o.category,
                motion_state=objects_pb2.MotionState.Name(o.motion_state),
                position=o.position,
                velocity=o.velocity,
                heading_rad=o.heading_rad,
                size=o.size,
                position_sigma=o.position_sigma,
                velocity_sigma=o.velocity_sigma,
                by_depth=o.by_depth,
            )
            for o in record.objects
        ],
    )


def mapped_objects_to_record(message: mapped_objects_pb2.MappedObjects) -> MappedObjects:
    return MappedObjects(
        message.timestamp_ns,
        message.map_id,
        message.metric_scale,
        tuple(
            MappedObject(
                object_id=o.object_id,
                category=o.category,
                motion_state=MotionState(o.motion_state),
                position=_three(o.position, "position"),
                velocity=_three(o.velocity, "velocity"),
                heading_rad=o.heading_rad,
                size=_three(o.size, "size"),
                position_sigma=o.position_sigma,
                velocity_sigma=o.velocity_sigma,
                by_depth=o.by_depth,
            )
            for o in message.objects
        ),
    )


def _three(numbers: Sequence[float], name: str) -> tuple[float, float, float]:
    if len(numbers) != 3:
        raise ProtocolError(f"{name} of a mapped object: expected 3 numbers, got {len(numbers)}")
    first, second, third = numbers
    return first, second, third
