# SPDX-License-Identifier: Apache-2.0
"""The synchronizer: complete bundles, or a reason; never without bound."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from schemas import topics
from schemas.codec import encode
from schemas.errors import ProtocolError
from schemas.records import EndOfInput, FrameManifest
from schemas.topics import Topic
from services.runtime.bus import Message
from services.runtime.envelope import Envelope
from services.runtime.synchronizer import RawBundle, Synchronizer

AWAITS = (topics.IMAGE, topics.DEPTH, topics.OBJECTS)


def message(topic: Topic, sequence: int, listed: tuple[Topic, ...] = (topics.IMAGE,)) -> Message:
    time_ns = sequence * 100
    payload = b"-"
    if topic is topics.MANIFEST:
        payload = encode(topic, FrameManifest(time_ns, "s", "n", tuple(t.key for t in listed)))
    if topic is topics.END:
        payload = encode(topic, EndOfInput(time_ns, sequence))
    return Message(topic, Envelope("s", sequence, time_ns), payload)


def feed(synchronizer: Synchronizer, *messages: Message, now_ns: int = 0) -> list[RawBundle]:
    bundles = (synchronizer.add(one, now_ns) for one in messages)
    return [bundle for bundle in bundles if bundle is not None]


def frame(sequence: int) -> list[Message]:
    return [message(t, sequence) for t in (topics.MANIFEST, topics.IMAGE, topics.OBJECTS)]


def test_a_camera_topic_is_awaited_only_when_the_manifest_lists_it() -> None:
    synchronizer = Synchronizer(AWAITS)
    assert len(feed(synchronizer, *frame(0))) == 1
    with_depth = message(topics.MANIFEST, 1, (topics.IMAGE, topics.DEPTH))
    assert feed(synchronizer, with_depth, message(topics.IMAGE, 1), message(topics.OBJECTS, 1)) == []
    (bundle,) = feed(synchronizer, message(topics.DEPTH, 1))
    assert set(bundle.messages) == {topics.MANIFEST, *AWAITS}


def test_the_end_takes_the_manifests_place() -> None:
    synchronizer = Synchronizer((topics.TRACKED_FRAME,), final_awaits=(topics.MAP_UPDATE,))
    assert feed(synchronizer, message(topics.END, 9)) == []
    (bundle,) = feed(synchronizer, message(topics.MAP_UPDATE, 9))
    assert topics.END in bundle.messages


def test_the_oldest_incomplete_frame_goes_when_there_are_too_many() -> None:
    synchronizer = Synchronizer(AWAITS, capacity=3)
    feed(synchronizer, *(message(topics.IMAGE, n) for n in range(5)))
    assert synchronizer.pending == 3
    assert [dropped.envelope.sequence for dropped in synchronizer.take_dropped()] == [0, 1]
    assert synchronizer.take_dropped() == []


def test_a_newer_complete_frame_overtakes_older_ones() -> None:
    synchronizer = Synchronizer(AWAITS, newest_wins=True)
    feed(synchronizer, message(topics.IMAGE, 0), *frame(1))
    (dropped,) = synchronizer.take_dropped()
    assert (dropped.envelope.sequence, dropped.reason) == (0, "overtaken by a newer frame")
    assert dropped.missing == (topics.MANIFEST.key,)
    assert feed(synchronizer, *frame(0)) == []
    assert synchronizer.counts["late"] == 3


def test_a_deadline_does_not_wait_for_what_may_be_lacking() -> None:
    synchronizer = Synchronizer(AWAITS, deferrable=(topics.OBJECTS,), deadline_ns=50, newest_wins=True)
    feed(synchronizer, message(topics.MANIFEST, 0), now_ns=0)
    assert synchronizer.due(1000) == []  # the image itself is not deferrable
    feed(synchronizer, message(topics.IMAGE, 0), now_ns=10)
    assert synchronizer.due(49) == []
    (bundle,) = synchronizer.due(50)
    assert bundle.missing == (topics.OBJECTS.key,)


def test_an_unreadable_manifest_leaves_nothing_behind() -> None:
    synchronizer = Synchronizer(AWAITS)
    with pytest.raises(ProtocolError, match="camera/manifest"):
        synchronizer.add(Message(topics.MANIFEST, Envelope("s", 0, 0), b"\xff\xff\xff"), 0)
    assert synchronizer.pending == 0
    assert len(feed(synchronizer, *frame(0))) == 1


@given(st.data())
def test_any_order_and_any_repeats_give_each_frame_complete(data: st.DataObject) -> None:
    frames = 6
    originals = [one for n in range(frames) for one in frame(n)]
    repeats = data.draw(st.lists(st.sampled_from(originals), max_size=6))
    order = data.draw(st.permutations(originals + repeats))
    synchronizer = Synchronizer(AWAITS, capacity=2 * frames)
    bundles = feed(synchronizer, *order)
    assert {bundle.envelope.sequence for bundle in bundles} == set(range(frames))
    assert all(len(bundle.messages) == 3 for bundle in bundles)
    assert all(len({m.envelope for m in bundle.messages.values()}) == 1 for bundle in bundles)
    assert synchronizer.take_dropped() == []


@given(st.lists(st.tuples(st.integers(0, 40), st.sampled_from([topics.IMAGE, topics.OBJECTS, topics.MANIFEST]))))
def test_memory_is_bounded_and_nothing_vanishes_without_a_reason(arrivals: list[tuple[int, Topic]]) -> None:
    synchronizer = Synchronizer(AWAITS, capacity=4)
    begun: set[int] = set()
    given_up: set[int] = set()
    for sequence, topic in arrivals:
        begun.add(sequence)
        bundle = synchronizer.add(message(topic, sequence), 0)
        if bundle is not None:
            given_up.add(bundle.envelope.sequence)
        given_up |= {dropped.envelope.sequence for dropped in synchronizer.take_dropped()}
        assert synchronizer.pending <= 4
    assert len(begun - given_up) <= synchronizer.pending
