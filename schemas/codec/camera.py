# SPDX-License-Identifier: Apache-2.0
"""What the camera gives, as Foxglove's messages where Foxglove has one."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration as CameraCalibrationMessage
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3

from schemas.codec.arrays import (
    MAX_PIXELS,
    box_of,
    labels_to_array,
    labels_to_message,
    nanoseconds_of,
    timestamp_of,
    vector_of,
)
from schemas.codec.rigid import matrix_from_pose, pose_from_matrix
from schemas.proto.kinemap import camera_pb2
from schemas.records.camera import (
    CameraCalibration,
    DepthImage,
    DistortionModel,
    EndOfInput,
    FrameManifest,
    Image,
    TrueInstances,
    TrueObject,
    TruePose,
)

_COEFFICIENTS: dict[DistortionModel, int] = {"plumb_bob": 5, "kannala_brandt": 4}
_ENCODINGS: dict[str, tuple[str, int]] = {"mono8": ("u1", 1), "bgr8": ("u1", 3), "32FC1": ("<f4", 1)}


def raw_image(timestamp_ns: int, frame_id: str, pixels: npt.NDArray[Any], encoding: str) -> RawImage:
    """A foxglove.RawImage of a contiguous array."""
    height, width = pixels.shape[:2]
    data = np.ascontiguousarray(pixels)
    return RawImage(
        timestamp=timestamp_of(timestamp_ns),
        frame_id=frame_id,
        width=width,
        height=height,
        encoding=encoding,
        step=data.strides[0] if height else 0,
        data=data.tobytes(),
    )


def pixels_of(message: RawImage) -> npt.NDArray[Any]:
    """The pixels of a RawImage, (H, W) or (H, W, 3). Raises ValueError for an unknown encoding or a cut-off image."""
    if message.encoding not in _ENCODINGS:
        raise ValueError(f"image encoding {message.encoding!r}, expected one of {', '.join(_ENCODINGS)}")
    dtype, channels = _ENCODINGS[message.encoding]
    expected = message.width * message.height * channels * np.dtype(dtype).itemsize
    if message.width * message.height > MAX_PIXELS or len(message.data) != expected:
        raise ValueError(
            f"image of {len(message.data)} bytes, expected {expected} for "
            f"{message.width}x{message.height} {message.encoding}"
        )
    shape = (message.height, message.width) if channels == 1 else (message.height, message.width, channels)
    return np.frombuffer(message.data, dtype=dtype).reshape(shape)


def image_to_message(record: Image) -> RawImage:
    return raw_image(
        record.timestamp_ns, record.frame_id, record.pixels, "mono8" if record.pixels.ndim == 2 else "bgr8"
    )


def image_to_record(message: RawImage) -> Image:
    if message.encoding == "32FC1":
        raise ValueError("image encoding '32FC1', expected mono8 or bgr8")
    return Image(nanoseconds_of(message.timestamp), pixels_of(message), message.frame_id)


def depth_to_message(record: DepthImage) -> RawImage:
    return raw_image(record.timestamp_ns, record.frame_id, record.depth_m.astype("<f4", copy=False), "32FC1")


def depth_to_record(message: RawImage) -> DepthImage:
    if message.encoding != "32FC1":
        raise ValueError(f"depth encoding {message.encoding!r}, expected '32FC1'")
    return DepthImage(nanoseconds_of(message.timestamp), pixels_of(message), message.frame_id)


def calibration_to_message(record: CameraCalibration) -> CameraCalibrationMessage:
    projection = record.projection
    if projection is None:
        projection = np.hstack((record.intrinsics, np.zeros((3, 1))))
    return CameraCalibrationMessage(
        timestamp=timestamp_of(record.timestamp_ns),
        frame_id=record.frame_id,
        width=record.width,
        height=record.height,
        distortion_model=record.distortion_model,
        D=record.distortion or (0.0,) * _COEFFICIENTS[record.distortion_model],
        K=record.intrinsics.ravel().tolist(),
        R=np.eye(3).ravel().tolist(),
        P=projection.ravel().tolist(),
    )


def calibration_to_record(message: CameraCalibrationMessage) -> CameraCalibration:
    distortion = tuple(message.D)
    model = next((known for known in _COEFFICIENTS if known == message.distortion_model), None)
    if model is None:
        raise ValueError(f"distortion_model {message.distortion_model!r}, expected one of {', '.join(_COEFFICIENTS)}")
    return CameraCalibration(
        nanoseconds_of(message.timestamp),
        message.width,
        message.height,
        vector_of("K", message.K, 9).reshape(3, 3),
        distortion if any(distortion) else (),
        vector_of("P", message.P, 12).reshape(3, 4),
        message.frame_id,
        model,
    )


def pose_message(timestamp_ns: int, frame_id: str, pose: npt.NDArray[np.float64]) -> PoseInFrame:
    """A foxglove.PoseInFrame of (7,) tx ty tz qx qy qz qw."""
    x, y, z, qx, qy, qz, qw = (float(value) for value in pose)
    return PoseInFrame(
        timestamp=timestamp_of(timestamp_ns),
        frame_id=frame_id,
        pose=Pose(position=Vector3(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw)),
    )


def pose_vector(message: PoseInFrame) -> npt.NDArray[np.float64]:
    """(7,) tx ty tz qx qy qz qw. Raises ValueError when a number is not finite."""
    p, q = message.pose.position, message.pose.orientation
    values = (p.x, p.y, p.z, q.x, q.y, q.z, q.w)
    if not all(math.isfinite(value) for value in values):
        raise ValueError(f"pose {values}, expected finite numbers")
    return np.array(values)


def true_pose_to_message(record: TruePose) -> PoseInFrame:
    return pose_message(record.timestamp_ns, "world", pose_from_matrix(record.world_from_camera))


def true_pose_to_record(message: PoseInFrame) -> TruePose:
    return TruePose(nanoseconds_of(message.timestamp), matrix_from_pose(pose_vector(message)))


def true_instances_to_message(record: TrueInstances) -> camera_pb2.TrueInstances:
    return camera_pb2.TrueInstances(
        timestamp_ns=record.timestamp_ns,
        labels=labels_to_message(record.labels),
        objects=[
            camera_pb2.TrueObject(
                instance_id=o.instance_id,
                category=o.category,
                moving=o.moving,
                velocity_m_s=o.velocity_m_s,
                position_m=o.position_m,
                box_px=o.box_px,
                heading_rad=o.heading_rad,
                size_m=o.size_m or (),
            )
            for o in record.objects
        ],
    )


def true_instances_to_record(message: camera_pb2.TrueInstances) -> TrueInstances:
    def xyz(name: str, values: Any) -> tuple[float, float, float]:
        x, y, z = vector_of(name, values, 3).tolist()
        return x, y, z

    return TrueInstances(
        message.timestamp_ns,
        labels_to_array(message.labels),
        tuple(
            TrueObject(
                o.instance_id,
                o.category,
                o.moving,
                xyz("velocity_m_s", o.velocity_m_s),
                xyz("position_m", o.position_m),
                box_of(o.box_px),
                o.heading_rad,
                xyz("size_m", o.size_m) if o.size_m else None,
            )
            for o in message.objects
        ),
    )


def manifest_to_message(record: FrameManifest) -> camera_pb2.FrameManifest:
    return camera_pb2.FrameManifest(
        timestamp_ns=record.timestamp_ns,
        source=record.source,
        frame_name=record.frame_name,
        topics=record.topics,
        frame_count=record.frame_count,
        rate_hz=record.rate_hz,
    )


def manifest_to_record(message: camera_pb2.FrameManifest) -> FrameManifest:
    return FrameManifest(
        message.timestamp_ns,
        message.source,
        message.frame_name,
        tuple(message.topics),
        message.frame_count,
        message.rate_hz,
    )


def end_to_message(record: EndOfInput) -> camera_pb2.EndOfInput:
    return camera_pb2.EndOfInput(timestamp_ns=record.timestamp_ns, frame_count=record.frame_count)


def end_to_record(message: camera_pb2.EndOfInput) -> EndOfInput:
    return EndOfInput(message.timestamp_ns, message.frame_count)
