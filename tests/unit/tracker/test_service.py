# SPDX-License-Identifier: Apache-2.0
"""The tracker service, frame by frame, as the loop calls it."""

from schemas import topics
from schemas.codec import encode
from services.runtime.config import Config
from services.runtime.envelope import Envelope
from services.runtime.service import Bundle
from services.tracker.service import TrackerService
from tests.unit.tracker.instance_frames import Box, frame


def sent(service: TrackerService, index: int) -> list[bytes]:
    motions = frame(index, Box(20 + 5 * index, 40, 30, 20, probability=0.9), Box(200, 30, 20, 50, "person"))
    bundle = Bundle(Envelope("session", index, motions.timestamp_ns), {topics.INSTANCE_MOTIONS: motions})
    outgoing = service.process(bundle)
    assert [out.topic for out in outgoing] == [topics.OBJECTS]
    return [encode(out.topic, out.record) for out in outgoing]


def test_a_killed_service_says_the_same_bytes() -> None:
    whole, first, second = (TrackerService(Config()) for _ in range(3))
    expected = [sent(whole, index) for index in range(6)]
    for index in range(3):
        sent(first, index)
    state = first.snapshot()
    assert state is not None
    second.restore(state)
    assert [sent(second, index) for index in range(3, 6)] == expected[3:]


def test_metrics_count_objects() -> None:
    service = TrackerService(Config())
    for index in range(3):
        sent(service, index)
    assert service.metrics() == {"objects_seen": 2.0, "objects_remembered": 2.0, "moving_objects": 1.0}
