# SPDX-License-Identifier: Apache-2.0
"""Which messages of which frame are here, and when a frame is complete. Pure: no bus, no disk, no clock."""

from collections import Counter
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from schemas import topics
from schemas.codec import decode
from schemas.topics import Topic
from services.recorder.recorded_key import key_of
from services.runtime.bus import Message
from services.runtime.envelope import Envelope
from services.runtime.session_file import RecordedMessage

_RECORDED_KEYS = frozenset(topic.key for topic in topics.TOPICS if topic.recorded)
_POSITION = {topic: index for index, topic in enumerate(topics.TOPICS)}


class ReleasedFrame(NamedTuple):
    """A frame to write and to answer. `messages` is empty for one that is on disk already."""

    envelope: Envelope
    messages: tuple[RecordedMessage, ...]
    ends: bool
    """it is the end of input"""


@dataclass
class _PendingFrame:
    envelope: Envelope
    messages: dict[tuple[Topic, str], Message] = field(default_factory=dict)
    answers: set[str] = field(default_factory=set)
    required: set[str] = field(default_factory=lambda: {topics.MANIFEST.key})


class FrameLedger:
    """Collects the messages of frames and releases each frame once, its messages in the order of the topic table.

    A frame is complete when the camera's manifest and all that it lists are here, one message of every per-frame topic
    of `producers`, the pose of a tracked frame, and the answers of `answering`, behind which nothing of theirs comes.
    The end of input takes the place of a frame, with the last changes of the map.

    `lossless`: frames are released in sequence and only when complete. Otherwise (realtime) a complete frame releases
    all older ones as they are, and what comes later still goes out with the next.

    `recorded` are the keys and sequences that are on disk from before a restart.
    """

    def __init__(
        self,
        producers: Collection[str],
        answering: Collection[str],
        *,
        lossless: bool,
        capacity: int,
        recorded: Iterable[tuple[str, int]] = (),
    ) -> None:
        self._per_frame = frozenset(
            topic.key
            for topic in topics.TOPICS
            if topic.per_frame and topic.recorded and topic.producer in producers and topic.producer != "camera"
        )
        self._at_the_end = {topics.END.key} | (
            {topics.MAP_UPDATE.key} if topics.MAP_UPDATE.producer in producers else set()
        )
        self._answering = frozenset(answering) & frozenset(producers)
        self._lossless = lossless
        self._capacity = capacity
        self._pending: dict[int, _PendingFrame] = {}
        self._recorded = dict.fromkeys(recorded)
        self.last_sequence = max((sequence for _, sequence in self._recorded), default=-1)
        self.counts: Counter[str] = Counter()

    def add(self, message: Message) -> list[ReleasedFrame]:
        """Take one message; give back the frames that it releases, oldest first.

        Raises ProtocolError for a manifest that cannot be read.
        """
        sequence = message.envelope.sequence
        if self._lossless and sequence <= self.last_sequence:
            return self._repeated(message)
        frame = self._pending.get(sequence)
        if frame is None:
            if len(self._pending) >= self._capacity and not self._make_room(sequence):
                return []
            frame = self._pending[sequence] = _PendingFrame(message.envelope)
        if message.topic is topics.ANSWER:
            frame.answers.add(message.suffix)
        elif self._is_new(frame, message):
            self._require(frame, message)
            frame.messages[message.topic, message.suffix] = message
        return self._release(sequence)

    def drain(self) -> list[ReleasedFrame]:
        """Everything that waits, complete or not, oldest first (realtime; lossless gives nothing unanswered away)."""
        return [] if self._lossless else [self._pop(sequence) for sequence in sorted(self._pending)]

    def _is_new(self, frame: _PendingFrame, message: Message) -> bool:
        key = key_of(message.topic, message.suffix)
        if (message.topic, message.suffix) in frame.messages or (key, message.envelope.sequence) in self._recorded:
            self.counts["duplicate"] += 1
            return False
        return True

    def _repeated(self, message: Message) -> list[ReleasedFrame]:
        self.counts["duplicate"] += 1
        if message.topic in (topics.MANIFEST, topics.END):
            return [ReleasedFrame(message.envelope, (), message.topic is topics.END)]
        return []

    def _make_room(self, sequence: int) -> bool:
        """Drop the newest frame, which the camera sends again; false when that is the one to come."""
        newest = max(self._pending)
        self.counts["frames_over_capacity"] += 1
        if sequence > newest:
            return False
        del self._pending[newest]
        return True

    def _release(self, sequence: int) -> list[ReleasedFrame]:
        if self._lossless:
            released = []
            while (frame := self._pending.get(self.last_sequence + 1)) is not None and self._complete(frame):
                released.append(self._pop(self.last_sequence + 1))
            return released
        if self._complete(self._pending[sequence]) or len(self._pending) >= self._capacity:
            return [self._pop(older) for older in sorted(self._pending) if older <= sequence]
        return []

    def _pop(self, sequence: int) -> ReleasedFrame:
        frame = self._pending.pop(sequence)
        self.last_sequence = max(self.last_sequence, sequence)
        ordered = sorted(frame.messages, key=lambda name: (_POSITION[name[0]], name[1]))
        messages = []
        for name in ordered:
            message = frame.messages[name]
            key = key_of(message.topic, message.suffix)
            self._recorded[key, sequence] = None
            messages.append(RecordedMessage(key, sequence, message.envelope.timestamp_ns, message.payload))
        self._forget_old()
        return ReleasedFrame(frame.envelope, tuple(messages), any(name[0] is topics.END for name in ordered))

    def _forget_old(self) -> None:
        """Keep the memory of what is on disk bounded: a repetition is never older than a few windows."""
        while len(self._recorded) > self._capacity * len(topics.TOPICS):
            del self._recorded[next(iter(self._recorded))]

    def _require(self, frame: _PendingFrame, message: Message) -> None:
        """Learn from a message which others its frame has. Raises ProtocolError when it cannot be read."""
        if message.topic is topics.MANIFEST:
            listed = decode(topics.MANIFEST, message.payload).topics
            frame.required |= self._per_frame | _RECORDED_KEYS.intersection(listed)
        elif message.topic is topics.END:
            frame.required = set(self._at_the_end)
        elif message.topic is topics.TRACKED_FRAME:
            tracked = decode(topics.TRACKED_FRAME, message.payload).map_from_camera is not None
            frame.required |= {topics.POSE.key} if tracked else set()

    def _complete(self, frame: _PendingFrame) -> bool:
        return self._answering <= frame.answers and frame.required <= {topic.key for topic, _ in frame.messages}
