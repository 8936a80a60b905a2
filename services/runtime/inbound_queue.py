# SPDX-License-Identifier: Apache-2.0
"""The queue between a bus's delivery thread and the service's loop."""

import threading
from collections import Counter, deque

from schemas.topics import WhenFull
from services.runtime.bus import Message
from services.runtime.envelope import Envelope


class InboundQueue:
    """First in, first out. With `keep_all` false, a topic that drops its oldest keeps `queue_depth` messages.

    What is sent again of a frame while it still waits here is not kept twice: a service that is slow, and is therefore
    sent frames again, must not come to hold more of them.
    """

    def __init__(self, *, keep_all: bool) -> None:
        self._keep_all = keep_all
        self._messages: deque[Message] = deque()
        self._waiting: Counter[str] = Counter()
        self._of_frames: Counter[tuple[str, Envelope]] = Counter()
        self._drops: Counter[str] = Counter()
        self._arrived = threading.Condition()
        self._closed = False

    def put(self, message: Message) -> None:
        """Add a message; where its topic's queue is full, its oldest goes."""
        key = message.topic.key
        with self._arrived:
            if self._closed or self._waits_already(message):
                return
            bounded = not self._keep_all and message.topic.when_full is WhenFull.DROP_OLDEST
            if bounded and self._waiting[key] >= message.topic.queue_depth:
                oldest = next(index for index, waiting in enumerate(self._messages) if waiting.topic.key == key)
                self._left(self._messages[oldest])
                del self._messages[oldest]
                self._drops[key] += 1
            self._messages.append(message)
            self._waiting[key] += 1
            self._of_frames[_frame_of(message)] += 1
            self._arrived.notify()

    def count_unreadable(self, key: str) -> None:
        """Count a message that could not even be taken out of its envelope."""
        with self._arrived:
            self._drops[f"{key} unreadable"] += 1

    def receive(self, timeout_s: float) -> Message | None:
        """The oldest message, or None when none came within `timeout_s`."""
        with self._arrived:
            if not self._messages and not self._closed:
                self._arrived.wait(timeout_s)
            if not self._messages:
                return None
            message = self._messages.popleft()
            self._left(message)
            return message

    def frame_times_ns(self) -> set[int]:
        """The frames that something waits of."""
        with self._arrived:
            return {envelope.timestamp_ns for _, envelope in self._of_frames}

    def drop_counts(self) -> dict[str, int]:
        """Drops so far, by topic."""
        with self._arrived:
            return dict(self._drops)

    def close(self) -> None:
        """Take no more; what waits can still be received."""
        with self._arrived:
            self._closed = True
            self._arrived.notify_all()

    def _waits_already(self, message: Message) -> bool:
        return (
            message.topic.per_frame
            and _frame_of(message) in self._of_frames
            and any(waiting == message for waiting in self._messages)
        )

    def _left(self, message: Message) -> None:
        self._waiting[message.topic.key] -= 1
        frame = _frame_of(message)
        self._of_frames[frame] -= 1
        if not self._of_frames[frame]:
            del self._of_frames[frame]


def _frame_of(message: Message) -> tuple[str, Envelope]:
    return message.topic.key, message.envelope
