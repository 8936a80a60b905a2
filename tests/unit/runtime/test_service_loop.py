# SPDX-License-Identifier: Apache-2.0
"""The loop: every frame once and in sequence, the same bytes for a repeated one, and on where a killed one was."""

from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from schemas import topics
from schemas.codec import decode, encode
from schemas.records import EndOfInput, FrameManifest, Instances, Objects
from schemas.topics import Topic
from services.runtime.bus import Message
from services.runtime.config.delivery import DeliveryConfig
from services.runtime.envelope import Envelope
from services.runtime.fake_bus import FakeBus, FakeNetwork
from services.runtime.outbox import Outbox, State
from services.runtime.service import Bundle, FrameService, Outgoing
from services.runtime.service_loop import FrameLoop

NO_LABELS = np.zeros((2, 2), dtype=np.uint32)


class Adder(FrameService):
    """Counts the frames it has processed and says the count in its output's label image."""

    name: ClassVar[str] = "segmenter"
    awaits: ClassVar[tuple[Topic, ...]] = (topics.OBJECTS,)
    answers: ClassVar[bool] = True

    def __init__(self, *, stateful: bool = True) -> None:
        self.stateful = stateful
        self.total = 0
        self.seen: list[int] = []
        self.finished = 0

    def process(self, bundle: Bundle) -> list[Outgoing]:
        self.total += 1
        self.seen.append(bundle.envelope.sequence)
        labels = np.full((2, 2), self.total, dtype=np.uint32)
        return [Outgoing(topics.INSTANCES, Instances(bundle.timestamp_ns, labels, ()))]

    def finish(self, bundle: Bundle) -> list[Outgoing]:
        self.finished += 1
        return []

    def snapshot(self) -> State | None:
        return {"total": np.array(self.total)} if self.stateful else None

    def restore(self, state: State) -> None:
        self.total = int(state["total"])


class Rig:
    """One loop, and the two ends of its bus."""

    def __init__(self, service: FrameService, *, mode: str = "lossless", folder: Path | None = None) -> None:
        network = FakeNetwork()
        self.upstream = FakeBus(network)
        self.heard = FakeBus(network).subscribe([topics.INSTANCES, topics.ANSWER])
        delivery = DeliveryConfig.model_validate({"mode": mode, "window": 4})
        self.loop = FrameLoop(service, FakeBus(network), delivery, "s", Outbox(8, folder))

    def send(self, *sequences: int, session: str = "s") -> None:
        for n in sequences:
            envelope = Envelope(session, n, n * 100)
            self.upstream.publish(
                topics.MANIFEST, encode(topics.MANIFEST, FrameManifest(n * 100, "s", "n", ())), envelope
            )
            self.upstream.publish(topics.OBJECTS, encode(topics.OBJECTS, Objects(n * 100, NO_LABELS, ())), envelope)
        self.run()

    def run(self) -> None:
        while self.loop.step(0.0):
            pass

    def outputs(self) -> list[Message]:
        messages = []
        while (one := self.heard.receive(0.0)) is not None:
            messages.append(one)
        return messages


def totals(messages: list[Message]) -> list[tuple[int, int]]:
    return [
        (m.envelope.sequence, int(decode(topics.INSTANCES, m.payload).labels[0, 0]))
        for m in messages
        if m.topic is topics.INSTANCES
    ]


def test_frames_are_processed_in_sequence_however_they_come() -> None:
    service = Adder()
    rig = Rig(service)
    rig.send(2, 1, 0, 3)
    assert service.seen == [0, 1, 2, 3]


def test_a_repeated_frame_gets_the_same_bytes_and_is_processed_once() -> None:
    service = Adder()
    rig = Rig(service)
    rig.send(0, 1)
    first = rig.outputs()
    rig.send(0)
    again = rig.outputs()
    assert service.seen == [0, 1]
    assert [(m.topic, m.payload) for m in again] == [(m.topic, m.payload) for m in first if m.envelope.sequence == 0]
    assert [m.topic for m in again] == [topics.INSTANCES, topics.ANSWER]


def test_a_killed_service_goes_on_where_it_was(tmp_path: Path) -> None:
    Rig(Adder(), folder=tmp_path).send(0, 1, 2)
    successor = Adder()
    rig = Rig(successor, folder=tmp_path)
    rig.send(4, 2, 3)
    assert successor.seen == [3, 4]
    assert totals(rig.outputs()) == [(2, 3), (3, 4), (4, 5)]


def test_old_frames_leave_no_files(tmp_path: Path) -> None:
    Rig(Adder(), folder=tmp_path).send(*range(40))
    assert len(list(tmp_path.iterdir())) == 8 + 1


def test_a_stateless_service_takes_frames_as_they_come() -> None:
    service = Adder(stateful=False)
    rig = Rig(service)
    rig.send(5, 3, 5)
    assert service.seen == [5, 3]


def test_realtime_never_waits_for_a_missing_frame() -> None:
    service = Adder()
    rig = Rig(service, mode="realtime")
    for sequence in (5, 3, 7):
        rig.send(sequence)
    assert service.seen == [5, 7]


def test_the_end_is_finished_once_and_answered_again() -> None:
    service = Adder()
    rig = Rig(service)
    rig.send(0)
    rig.outputs()
    for _ in range(2):
        rig.upstream.publish(topics.END, encode(topics.END, EndOfInput(100, 1)), Envelope("s", 1, 100))
        rig.run()
    assert service.finished == 1
    assert rig.loop.ended
    assert [m.envelope.sequence for m in rig.outputs()] == [1, 1]


@pytest.mark.parametrize("payload", [b"", b"\x08\x63", b"\xff\xff\xff\xff"])
def test_a_broken_message_is_counted_and_never_a_crash(payload: bytes) -> None:
    service = Adder()
    rig = Rig(service)
    envelope = Envelope("s", 0, 0)
    rig.upstream.publish(topics.MANIFEST, payload, envelope)
    rig.upstream.publish(topics.OBJECTS, payload, envelope)
    rig.run()
    rig.send(0)
    rig.send(0)  # the camera sends an unanswered frame again
    assert service.seen == [0]
    assert rig.loop.metrics.values()["messages_unreadable"] >= 1


def test_another_session_is_not_ours() -> None:
    service = Adder()
    rig = Rig(service)
    rig.send(0, session="yesterday")
    assert service.seen == []
    assert rig.loop.metrics.values()["other_session"] == 2


def test_a_service_cannot_find_state_on_the_way() -> None:
    """It would be killed without a trace of it on disk."""
    service = Adder(stateful=False)
    rig = Rig(service)
    rig.send(0)
    service.stateful = True
    with pytest.raises(TypeError, match="snapshot"):
        rig.send(1)
