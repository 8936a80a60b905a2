# SPDX-License-Identifier: Apache-2.0
from schemas import topics
from schemas.topics import Topic
from services.runtime.bus import Message
from services.runtime.envelope import Envelope
from services.runtime.inbound_queue import InboundQueue


def _message(topic: Topic, frame: int, suffix: str = "", payload: bytes = b"payload") -> Message:
    return Message(topic, Envelope("test", frame, 1000 + frame), payload, suffix)


def _frames(queue: InboundQueue) -> list[int]:
    received = []
    while (message := queue.receive(0.0)) is not None:
        received.append(message.envelope.sequence)
    return received


def test_a_frame_that_is_sent_again_while_it_waits_is_kept_once() -> None:
    queue = InboundQueue(keep_all=True)
    for _ in range(3):
        for frame in range(4):
            queue.put(_message(topics.MANIFEST, frame))
            queue.put(_message(topics.IMAGE, frame))
    assert queue.frame_times_ns() == {1000, 1001, 1002, 1003}
    assert _frames(queue) == [0, 0, 1, 1, 2, 2, 3, 3]
    assert queue.frame_times_ns() == set()


def test_once_taken_it_is_heard_again() -> None:
    queue = InboundQueue(keep_all=True)
    for _ in range(2):
        queue.put(_message(topics.IMAGE, 7))
        assert _frames(queue) == [7]


def test_a_broken_message_does_not_stand_for_the_whole_one() -> None:
    queue = InboundQueue(keep_all=True)
    queue.put(_message(topics.IMAGE, 3, payload=b"pay"))
    queue.put(_message(topics.IMAGE, 3))
    assert _frames(queue) == [3, 3]


def test_answers_of_several_services_to_one_frame_are_all_kept() -> None:
    queue = InboundQueue(keep_all=True)
    for service in ("slam", "mapstore", "slam"):
        queue.put(_message(topics.ANSWER, 0, service))
    assert _frames(queue) == [0, 0, 0]


def test_the_newest_stays_where_a_topics_queue_is_full() -> None:
    queue = InboundQueue(keep_all=False)
    for frame in range(5):
        queue.put(_message(topics.IMAGE, frame))
    queue.put(_message(topics.IMAGE, 4))
    assert queue.drop_counts() == {"camera/image": 4}
    assert queue.frame_times_ns() == {1004}
    assert _frames(queue) == [4]
    queue.put(_message(topics.IMAGE, 3))
    assert _frames(queue) == [3]
