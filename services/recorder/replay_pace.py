# SPDX-License-Identifier: Apache-2.0
"""When the next message of a replay may go: at the recorded rate, or as fast as whoever listens allows."""

import threading
import time
from collections.abc import Callable, Collection
from typing import Protocol

from schemas import topics
from services.runtime.bus import Bus
from services.runtime.errors import KinemapError
from services.runtime.session_file import RecordedMessage


class Pace(Protocol):
    """Decides when a message may go."""

    def await_turn(self, message: RecordedMessage) -> bool:
        """Return when it is the message's turn; false when the replay was stopped meanwhile."""


class RecordedRate:
    """Messages go at `speed` times the rate they were captured at. Where the recorded clock jumps back, it goes on.

    Raises:
        ValueError: a speed that is not positive.
    """

    def __init__(self, speed: float, stop: threading.Event, clock: Callable[[], float] = time.monotonic) -> None:
        if not speed > 0:
            raise ValueError(f"speed {speed}: expected a positive number")
        self._speed = speed
        self._stop = stop
        self._clock = clock
        self._due_s: float | None = None
        self._last_ns = 0

    def await_turn(self, message: RecordedMessage) -> bool:
        """Wait until the message's capture time comes, counted from the first message's."""
        if self._due_s is None:
            self._due_s = self._clock()
        else:
            self._due_s += max(0, message.timestamp_ns - self._last_ns) * 1e-9 / self._speed
        self._last_ns = message.timestamp_ns
        return not self._stop.wait(max(0.0, self._due_s - self._clock()))


class AsAnswered:
    """Messages go as fast as they can be read, but no frame before `services` have answered the frame `window` before.

    Raises:
        KinemapError: from `await_turn`, no answer for `patience_s`.
    """

    def __init__(
        self,
        bus: Bus,
        session: str,
        services: Collection[str],
        *,
        stop: threading.Event,
        window: int = 8,
        patience_s: float = 60.0,
    ) -> None:
        self._session = session
        self._answered = dict.fromkeys(services, -1)
        self._stop = stop
        self._window = window
        self._patience_s = patience_s
        self._first: int | None = None
        self._answers = bus.subscribe([topics.ANSWER]) if services else None

    def await_turn(self, message: RecordedMessage) -> bool:
        """Wait until the message's frame is within the window."""
        if self._first is None:
            self._first = message.sequence
        needed = message.sequence - self._window
        give_up_s = time.monotonic() + self._patience_s
        while needed >= self._first and min(self._answered.values(), default=needed) < needed:
            if self._stop.is_set():
                return False
            if self._take_answer():
                give_up_s = time.monotonic() + self._patience_s
            elif time.monotonic() > give_up_s:
                late = ", ".join(name for name, sequence in self._answered.items() if sequence < needed)
                raise KinemapError(f"frame {needed}: no answer from {late} for {self._patience_s:g} s")
        return not self._stop.is_set()

    def _take_answer(self) -> bool:
        answer = self._answers.receive(0.1) if self._answers is not None else None
        if answer is None or answer.envelope.session != self._session or answer.suffix not in self._answered:
            return False
        self._answered[answer.suffix] = max(self._answered[answer.suffix], answer.envelope.sequence)
        return True
