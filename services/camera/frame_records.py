# SPDX-License-Identifier: Apache-2.0
"""What the camera says about one frame, in the order in which it says it."""

import os

from schemas import topics
from schemas.records import (
    CameraCalibration,
    DepthImage,
    FrameManifest,
    Image,
    TrueInstances,
    TruePose,
)
from schemas.topics import Topic
from services.camera.sources.source import Source, SourceFrame

CameraRecord = FrameManifest | CameraCalibration | Image | DepthImage | TruePose | TrueInstances


def frame_records(frame: SourceFrame, source: Source) -> list[tuple[Topic, CameraRecord]]:
    """The manifest first, so that receivers know what to wait for, then all that this frame has."""
    parts: list[tuple[Topic, CameraRecord | None]] = [
        (topics.CALIBRATION, frame.calibration),
        (topics.IMAGE, frame.image),
        (topics.CALIBRATION_RIGHT, frame.calibration_right),
        (topics.IMAGE_RIGHT, frame.image_right),
        (topics.DEPTH, frame.depth),
        (topics.TRUE_POSE, frame.true_pose),
        (topics.TRUE_INSTANCES, frame.true_instances),
    ]
    present = [(topic, record) for topic, record in parts if record is not None]
    manifest = FrameManifest(
        frame.timestamp_ns,
        _as_text(source.name),
        _as_text(frame.name),
        tuple(topic.key for topic, _ in present),
        source.frame_count,
        source.rate_hz,
    )
    return [(topics.MANIFEST, manifest), *present]


def _as_text(name: str) -> str:
    """A file's name may be any bytes, a message's text may not."""
    return os.fsencode(name).decode("utf-8", errors="replace")
