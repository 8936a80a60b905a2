# SPDX-License-Identifier: Apache-2.0
"""Each frame is released once, whole, in sequence, whatever order its messages come in."""

from hypothesis import given, settings
from hypothesis import strategies as st

from schemas import topics
from services.recorder.frame_ledger import FrameLedger, ReleasedFrame
from services.runtime.bus import Message
from tests.unit.recorder.recorded_frames import end_messages, frame_messages, message, recorded_frame

PRODUCERS = ("camera", "segmenter", "motion", "tracker", "slam", "mapstore")


def lossless(recorded: tuple[tuple[str, int], ...] = (), capacity: int = 32) -> FrameLedger:
    return FrameLedger(PRODUCERS, ("slam", "mapstore"), lossless=True, capacity=capacity, recorded=recorded)


def feed(ledger: FrameLedger, messages: list[Message]) -> list[ReleasedFrame]:
    return [released for entry in messages for released in ledger.add(entry)]


def test_a_frame_is_released_with_its_last_message_and_not_before() -> None:
    ledger = lossless()
    messages = frame_messages(0)
    for entry in messages[:-1]:
        assert ledger.add(entry) == []
    (frame,) = ledger.add(messages[-1])
    assert list(frame.messages) == recorded_frame(0)
    assert not frame.ends


@settings(max_examples=80, deadline=None)
@given(data=st.data())
def test_any_order_and_any_repetition_gives_the_same_frames(data: st.DataObject) -> None:
    frames = [*(frame_messages(sequence) for sequence in range(4)), end_messages(4)]
    queues = []
    for producer in PRODUCERS:
        # What one service sends for one frame keeps its order; the frames of it come as they like, and again.
        own = [[entry for entry in frame if producer in (entry.topic.producer, entry.suffix)] for frame in frames]
        repeated = data.draw(st.lists(st.sampled_from(own), max_size=3))
        queues.append([entry for block in data.draw(st.permutations(own + repeated)) for entry in block])
    released = []
    ledger = lossless()
    while waiting := [queue for queue in queues if queue]:
        released += ledger.add(data.draw(st.sampled_from(waiting)).pop(0))
    written = [frame for frame in released if frame.messages]
    assert [frame.envelope.sequence for frame in written] == [0, 1, 2, 3, 4]
    assert [list(frame.messages) for frame in written[:4]] == [recorded_frame(sequence) for sequence in range(4)]
    assert [entry.key for entry in written[4].messages] == ["slam/map_update", "camera/end"]
    assert written[4].ends


def test_the_end_waits_for_those_who_still_send() -> None:
    ledger = lossless()
    feed(ledger, frame_messages(0))
    ending = end_messages(1)
    assert feed(ledger, ending[:-1]) == []
    (frame,) = ledger.add(ending[-1])
    assert frame.ends
    assert frame.envelope.sequence == 1


def test_what_a_frame_can_have_is_waited_for_when_it_has_it() -> None:
    ledger = lossless()
    lost = [entry for entry in frame_messages(0) if entry.topic is not topics.POSE]
    assert feed(ledger, lost) == []
    assert len(ledger.add(message(topics.POSE, 0))) == 1
    assert feed(ledger, [entry for entry in end_messages(1) if entry.topic is not topics.MAP_UPDATE]) == []
    assert len(ledger.add(message(topics.MAP_UPDATE, 1))) == 1


def test_a_repeated_frame_is_answered_again_and_not_written_again() -> None:
    ledger = lossless()
    feed(ledger, frame_messages(0))
    again = feed(ledger, frame_messages(0))
    assert [(frame.envelope.sequence, frame.messages, frame.ends) for frame in again] == [(0, (), False)]


def test_after_a_restart_it_goes_on_behind_what_is_on_disk() -> None:
    on_disk = tuple((entry.key, sequence) for sequence in (0, 1) for entry in recorded_frame(sequence))
    ledger = lossless(recorded=on_disk)
    assert ledger.last_sequence == 1
    assert [frame.messages for frame in feed(ledger, frame_messages(1))] == [()]
    assert [frame.envelope.sequence for frame in feed(ledger, frame_messages(2))] == [2]


def test_a_service_that_does_not_run_is_not_waited_for() -> None:
    ledger = FrameLedger(("camera", "slam"), ("slam", "mapstore"), lossless=True, capacity=8)
    released = feed(ledger, [entry for entry in frame_messages(0) if entry.topic.producer in ("camera", "slam", "*")])
    assert len(released) == 1


def test_memory_is_bounded_and_the_oldest_frames_are_kept() -> None:
    ledger = lossless(capacity=4)
    for sequence in range(10):
        ledger.add(message(topics.MANIFEST, sequence))
    assert ledger.counts["frames_over_capacity"] == 6
    released = feed(ledger, [entry for sequence in range(4) for entry in frame_messages(sequence)])
    assert [frame.envelope.sequence for frame in released] == [0, 1, 2, 3]


def test_realtime_writes_everything_once_although_frames_stay_incomplete() -> None:
    ledger = FrameLedger(PRODUCERS, ("slam", "mapstore"), lossless=False, capacity=8)
    late = message(topics.OBJECTS, 0)
    sent = [entry for entry in frame_messages(0) if entry.topic is not topics.OBJECTS]
    assert feed(ledger, sent) == []
    released = feed(ledger, [*frame_messages(1), late, late, *frame_messages(2), message(topics.DENSITY, 3)])
    released += ledger.drain()
    keys = [(entry.key, entry.sequence) for frame in released for entry in frame.messages]
    assert len(keys) == len(set(keys)) == 3 * len(recorded_frame(0)) + 1
    assert [frame.envelope.sequence for frame in released] == [0, 1, 0, 2, 3]
