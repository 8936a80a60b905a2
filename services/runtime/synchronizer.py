# SPDX-License-Identifier: Apache-2.0
"""Joins the messages of one frame by capture time. Pure: no bus, no clock of its own, bounded memory."""

from collections import Counter
from dataclasses import dataclass, field
from typing import NamedTuple

from schemas.codec import decode
from schemas.topics import END, MANIFEST, Topic
from services.runtime.bus import Message
from services.runtime.envelope import Envelope


@dataclass
class RawBundle:
    """The messages of one frame, not decoded. `missing` is empty unless a deadline sent it off."""

    envelope: Envelope
    messages: dict[Topic, Message] = field(default_factory=dict)
    camera_topics: frozenset[str] | None = None
    """the camera's topics of this frame by its manifest; None until that is here"""
    since_ns: int = 0
    missing: tuple[str, ...] = ()


class Dropped(NamedTuple):
    """A frame that was given up, and why."""

    envelope: Envelope
    reason: str
    missing: tuple[str, ...]


class Synchronizer:
    """Collects what belongs to one timestamp until it is complete.

    A frame is complete when every topic of `awaits` is there: camera topics only if the frame's manifest lists them,
    the others always. The end of input takes the manifest's place for the frame that carries it, with `final_awaits`.

    `capacity` bounds the incomplete frames held; the oldest goes when one more begins. With `newest_wins`, frames
    older than a complete one are given up. With `deadline_ns`, `due` sends off frames that lack only topics of
    `deferrable` after that time.
    """

    def __init__(
        self,
        awaits: tuple[Topic, ...],
        *,
        final_awaits: tuple[Topic, ...] = (),
        deferrable: tuple[Topic, ...] = (),
        capacity: int = 64,
        newest_wins: bool = False,
        deadline_ns: int | None = None,
    ) -> None:
        self._awaits = awaits
        self._final_awaits = final_awaits
        self._deferrable = frozenset(topic.key for topic in deferrable)
        self._capacity = capacity
        self._newest_wins = newest_wins
        self._deadline_ns = deadline_ns
        self._pending: dict[int, RawBundle] = {}
        self._dropped: list[Dropped] = []
        self._newest_given_ns: int | None = None
        self.counts: Counter[str] = Counter()

    @property
    def pending(self) -> int:
        """Incomplete frames held."""
        return len(self._pending)

    def pending_times_ns(self) -> set[int]:
        """Their capture times."""
        return set(self._pending)

    def add(self, message: Message, now_ns: int) -> RawBundle | None:
        """Take one message; give back its frame's bundle if that completes it.

        Raises ProtocolError for a manifest that cannot be read.
        """
        envelope = message.envelope
        time_ns = envelope.timestamp_ns
        if self._newest_wins and self._newest_given_ns is not None and time_ns <= self._newest_given_ns:
            self.counts["late"] += 1
            return None
        camera_topics = frozenset(decode(MANIFEST, message.payload).topics) if message.topic is MANIFEST else None
        bundle = self._pending.get(time_ns)
        if bundle is None:
            if len(self._pending) >= self._capacity:
                self._drop(min(self._pending), "more incomplete frames than can be held")
            bundle = self._pending[time_ns] = RawBundle(envelope, since_ns=now_ns)
        if message.topic in bundle.messages:
            self.counts["duplicate"] += 1
        bundle.messages[message.topic] = message
        if camera_topics is not None:
            bundle.camera_topics = camera_topics
        if self._missing(bundle):
            return None
        return self._give(time_ns)

    def due(self, now_ns: int) -> list[RawBundle]:
        """Frames whose deadline has passed and that lack only what may be lacking, oldest first."""
        if self._deadline_ns is None:
            return []
        given = []
        for time_ns in sorted(self._pending):
            bundle = self._pending.get(time_ns)
            if bundle is None or now_ns - bundle.since_ns < self._deadline_ns:
                continue
            missing = self._missing(bundle)
            if missing and self._deferrable.issuperset(missing):
                bundle.missing = missing
                given.append(self._give(time_ns))
        return given

    def take_dropped(self) -> list[Dropped]:
        """The frames given up since the last call."""
        dropped, self._dropped = self._dropped, []
        return dropped

    def _missing(self, bundle: RawBundle) -> tuple[str, ...]:
        if END in bundle.messages:
            return tuple(topic.key for topic in self._final_awaits if topic not in bundle.messages)
        listed = bundle.camera_topics
        if listed is None:
            return (MANIFEST.key,)
        return tuple(
            topic.key
            for topic in self._awaits
            if topic not in bundle.messages and (topic.producer != "camera" or topic.key in listed)
        )

    def _give(self, time_ns: int) -> RawBundle:
        bundle = self._pending.pop(time_ns)
        if self._newest_wins:
            self._newest_given_ns = time_ns
            for older_ns in [pending_ns for pending_ns in self._pending if pending_ns < time_ns]:
                self._drop(older_ns, "overtaken by a newer frame")
        return bundle

    def _drop(self, time_ns: int, reason: str) -> None:
        bundle = self._pending.pop(time_ns)
        self.counts["dropped"] += 1
        self._dropped.append(Dropped(bundle.envelope, reason, self._missing(bundle)))
