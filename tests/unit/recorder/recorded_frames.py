# SPDX-License-Identifier: Apache-2.0
"""Small frames as they go over the bus: real records, encoded."""

from functools import cache

import numpy as np

from schemas import topics
from schemas.codec import encode
from schemas.records import (
    CameraCalibration,
    Density,
    DensityLevel,
    EgoMotion,
    EndOfInput,
    FrameAnswer,
    FrameManifest,
    Image,
    InstanceMotions,
    Instances,
    MappedObjects,
    MapUpdate,
    MaskSource,
    MovingMask,
    Objects,
    PoseInMap,
    TrackedFrame,
    TrackingState,
)
from schemas.topics import Topic
from services.runtime.bus import Message
from services.runtime.envelope import Envelope
from services.runtime.session_file import RecordedMessage

SESSION = "a-session"
PERIOD_NS = 100_000_000
CAMERA = (topics.CALIBRATION, topics.IMAGE)


def time_of(sequence: int) -> int:
    return 1_000_000_000 + sequence * PERIOD_NS


@cache
def payload(topic: Topic, sequence: int) -> bytes:
    """The bytes of `topic` in frame `sequence`: different in every frame."""
    t = time_of(sequence)
    labels = np.full((6, 8), sequence, dtype=np.uint32)
    pose = np.array([sequence, 0, 0, 0, 0, 0, 1], dtype=np.float64)
    records = {
        topics.MANIFEST: lambda: FrameManifest(
            t, "test", f"{sequence:06d}", tuple(topic.key for topic in CAMERA), -1, 10.0
        ),
        topics.CALIBRATION: lambda: CameraCalibration(t, 8, 6, np.array([[5.0, 0, 4], [0, 5, 3], [0, 0, 1]])),
        topics.IMAGE: lambda: Image(t, np.random.default_rng(sequence).integers(0, 256, (6, 8), dtype=np.uint8)),
        topics.INSTANCES: lambda: Instances(t, labels, ()),
        topics.EGO_MOTION: lambda: EgoMotion(
            t, t - PERIOD_NS, False, "still", np.eye(3), np.zeros(3), 0.0, 0, 0.0, 0.0
        ),
        topics.INSTANCE_MOTIONS: lambda: InstanceMotions(t, labels, ()),
        topics.MOVING_MASK: lambda: MovingMask(t, np.zeros((6, 8), dtype=np.uint8)),
        topics.OBJECTS: lambda: Objects(t, labels, ()),
        topics.TRACKED_FRAME: lambda: TrackedFrame(
            t, TrackingState.TRACKING, "", 0, pose, None, 0, pose, 100, 90, False, MaskSource.FRESH, False, "moving"
        ),
        topics.MAP_UPDATE: lambda: MapUpdate(t),
        topics.MAPPED_OBJECTS: lambda: MappedObjects(t),
        topics.DENSITY: lambda: Density(t, (0.0, 0.0, 0.0), 10.0, 30.0, sequence, 0, 5, DensityLevel.LOW, False),
        topics.POSE: lambda: PoseInMap(t, pose),
        topics.END: lambda: EndOfInput(t, sequence),
    }
    return encode(topic, records[topic]())


PER_FRAME = (
    topics.MANIFEST,
    *CAMERA,
    topics.INSTANCES,
    topics.EGO_MOTION,
    topics.INSTANCE_MOTIONS,
    topics.MOVING_MASK,
    topics.OBJECTS,
    topics.TRACKED_FRAME,
    topics.MAP_UPDATE,
    topics.MAPPED_OBJECTS,
    topics.DENSITY,
)


def message(topic: Topic, sequence: int, suffix: str = "") -> Message:
    """One message of frame `sequence`, as a subscription gives it."""
    envelope = Envelope(SESSION, sequence, time_of(sequence))
    if topic is topics.ANSWER:
        return Message(topic, envelope, encode(topic, FrameAnswer(envelope.timestamp_ns, suffix)), suffix)
    return Message(topic, envelope, payload(topic, sequence), suffix)


def frame_messages(sequence: int) -> list[Message]:
    """All of one frame, in the order of the data flow; slam's and mapstore's answers come behind what they sent."""
    return [
        *(message(topic, sequence) for topic in PER_FRAME[:-1]),
        message(topics.POSE, sequence),
        message(topics.ANSWER, sequence, "slam"),
        message(topics.DENSITY, sequence),
        message(topics.ANSWER, sequence, "mapstore"),
    ]


def end_messages(sequence: int) -> list[Message]:
    """The end of input, and what slam and mapstore say to it."""
    return [
        message(topics.END, sequence),
        message(topics.MAP_UPDATE, sequence),
        message(topics.ANSWER, sequence, "slam"),
        message(topics.ANSWER, sequence, "mapstore"),
    ]


def recorded_frame(sequence: int) -> list[RecordedMessage]:
    """One frame as it is written."""
    written = [topic for topic in topics.TOPICS if topic in PER_FRAME or topic is topics.POSE]
    return [RecordedMessage(topic.key, sequence, time_of(sequence), payload(topic, sequence)) for topic in written]
