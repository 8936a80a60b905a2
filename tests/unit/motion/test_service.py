# SPDX-License-Identifier: Apache-2.0
"""The motion service, frame by frame, as the loop calls it."""

import numpy as np

from schemas import topics
from schemas.codec import encode
from services.motion.service import MotionService
from services.runtime.config import Config
from services.runtime.envelope import Envelope
from services.runtime.service import Bundle
from tests.unit.motion.moving_pictures import picture


def bundle(index: int) -> Bundle:
    taken = picture(index, 0.6)
    return Bundle(
        Envelope("session", index, taken.image.timestamp_ns),
        {topics.IMAGE: taken.image, topics.CALIBRATION: taken.calibration, topics.INSTANCES: taken.instances},
    )


def sent(service: MotionService, index: int) -> list[bytes]:
    return [encode(out.topic, out.record) for out in service.process(bundle(index))]


def test_every_frame_gives_its_three_messages() -> None:
    service = MotionService(Config())
    for index in range(2):
        outgoing = service.process(bundle(index))
        assert [out.topic for out in outgoing] == [topics.EGO_MOTION, topics.INSTANCE_MOTIONS, topics.MOVING_MASK]
        assert {out.record.timestamp_ns for out in outgoing} == {bundle(index).timestamp_ns}
    assert service.metrics() == {"frames_without_ego_motion": 1.0, "moving_instances": 1.0}


def test_a_killed_service_says_the_same_bytes() -> None:
    whole, first, second = (MotionService(Config()) for _ in range(3))
    expected = [sent(whole, index) for index in range(4)]
    for index in range(2):
        sent(first, index)
    state = first.snapshot()
    assert state is not None
    assert all(array.dtype != np.dtype(object) for array in state.values())
    second.restore(state)
    assert [sent(second, index) for index in (2, 3)] == expected[2:]


def test_a_service_that_saw_nothing_has_no_state() -> None:
    assert MotionService(Config()).snapshot() == {}
