# SPDX-License-Identifier: Apache-2.0
"""What the motion service gives."""

from foxglove_schemas_protobuf.RawImage_pb2 import RawImage

from schemas.codec.arrays import box_of, labels_to_array, labels_to_message, nanoseconds_of, vector_of
from schemas.codec.camera import pixels_of, raw_image
from schemas.proto.kinemap import motion_pb2
from schemas.records.motion import EgoMotion, InstanceMotion, InstanceMotions, MovingMask


def ego_motion_to_message(record: EgoMotion) -> motion_pb2.EgoMotion:
    return motion_pb2.EgoMotion(
        timestamp_ns=record.timestamp_ns,
        previous_timestamp_ns=record.previous_timestamp_ns,
        valid=record.valid,
        reason=record.reason,
        rotation=record.rotation.ravel().tolist(),
        translation_direction=record.translation_direction.tolist(),
        inlier_ratio=record.inlier_ratio,
        samples=record.samples,
        background_flow_px=record.background_flow_px,
        parallax_px=record.parallax_px,
    )


def ego_motion_to_record(message: motion_pb2.EgoMotion) -> EgoMotion:
    return EgoMotion(
        message.timestamp_ns,
        message.previous_timestamp_ns,
        message.valid,
        message.reason,
        vector_of("rotation", message.rotation, 9).reshape(3, 3),
        vector_of("translation_direction", message.translation_direction, 3),
        message.inlier_ratio,
        message.samples,
        message.background_flow_px,
        message.parallax_px,
    )


def instance_motions_to_message(record: InstanceMotions) -> motion_pb2.InstanceMotions:
    return motion_pb2.InstanceMotions(
        timestamp_ns=record.timestamp_ns,
        labels=labels_to_message(record.labels),
        instances=[
            motion_pb2.InstanceMotion(
                instance_id=i.instance_id,
                category=i.category,
                score=i.score,
                box_px=i.box_px,
                moving_probability=i.moving_probability,
                epipolar_residual_px=i.epipolar_residual_px,
                residual_noise_px=i.residual_noise_px,
                samples=i.samples,
                age_frames=i.age_frames,
            )
            for i in record.instances
        ],
    )


def instance_motions_to_record(message: motion_pb2.InstanceMotions) -> InstanceMotions:
    return InstanceMotions(
        message.timestamp_ns,
        labels_to_array(message.labels),
        tuple(
            InstanceMotion(
                i.instance_id,
                i.category,
                i.score,
                box_of(i.box_px),
                i.moving_probability,
                i.epipolar_residual_px,
                i.residual_noise_px,
                i.samples,
                i.age_frames,
            )
            for i in message.instances
        ),
    )


def moving_mask_to_message(record: MovingMask) -> RawImage:
    return raw_image(record.timestamp_ns, "camera", record.mask, "mono8")


def moving_mask_to_record(message: RawImage) -> MovingMask:
    if message.encoding != "mono8":
        raise ValueError(f"mask encoding {message.encoding!r}, expected 'mono8'")
    return MovingMask(nanoseconds_of(message.timestamp), pixels_of(message))
