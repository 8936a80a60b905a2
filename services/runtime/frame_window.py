# SPDX-License-Identifier: Apache-2.0
"""The credits of `lossless`: how many frames may be on their way, and which have to be sent again."""

from collections.abc import Collection
from dataclasses import dataclass


@dataclass
class _FrameInFlight:
    missing: set[str]
    due_s: float
    wait_s: float


class FrameWindow:
    """Frames sent and not yet answered by every one of `services`; never more than `window` of them.

    Frame n may be sent when all services have answered every frame up to n - window. A frame that is not answered in
    `resend_after_s` is overdue; the wait doubles each time, up to `_LONGEST_WAIT` times the first, so that a service
    that is only slow is not buried in repetitions. Sequences count up by one from `first`. Times are any monotonic
    clock's seconds, given by the caller: this class knows no clock.

    Raises:
        ValueError: a window below 1, a wait that is not positive, or no services.
    """

    _LONGEST_WAIT = 8.0

    def __init__(self, window: int, services: Collection[str], resend_after_s: float, first: int = 0) -> None:
        if window < 1 or not resend_after_s > 0 or not services:
            raise ValueError(
                f"window {window}, resend after {resend_after_s} s, services {sorted(services)}: "
                "expected a window of at least 1, a positive time and at least one service"
            )
        self._window = window
        self._services = frozenset(services)
        self._resend_after_s = resend_after_s
        self._in_flight: dict[int, _FrameInFlight] = {}
        self._next = first

    @property
    def next_sequence(self) -> int:
        """The sequence to be sent next."""
        return self._next

    @property
    def done(self) -> int:
        """The last sequence up to which every frame is answered by everyone; one less than the first for none."""
        return min(self._in_flight, default=self._next) - 1

    @property
    def may_send(self) -> bool:
        """Whether the next frame may go."""
        return self._next - self.done <= self._window

    @property
    def in_flight(self) -> tuple[int, ...]:
        """The sequences from the first that is not answered by everyone on, in order, without those that are."""
        return tuple(sorted(self._in_flight))

    def sent(self, sequence: int, now_s: float) -> None:
        """The next frame is on its way.

        Raises:
            ValueError: another sequence than the next, or the window is full.
        """
        if sequence != self._next or not self.may_send:
            raise ValueError(f"frame {sequence} sent, expected {self._next} with {self._window} in flight at most")
        self._in_flight[sequence] = _FrameInFlight(
            set(self._services), now_s + self._resend_after_s, self._resend_after_s
        )
        self._next += 1

    def answered(self, service: str, sequence: int) -> bool:
        """A service has done its part of a frame. Whether that was news: repeated and unknown answers are none."""
        frame = self._in_flight.get(sequence)
        if frame is None or service not in frame.missing:
            return False
        frame.missing.remove(service)
        if not frame.missing:
            del self._in_flight[sequence]
        return True

    def missing(self, sequence: int) -> frozenset[str]:
        """Who has not answered this frame."""
        frame = self._in_flight.get(sequence)
        return frozenset() if frame is None else frozenset(frame.missing)

    def overdue(self, now_s: float) -> tuple[int, ...]:
        """The sequences to send again now, in order. Each is given once, then again after twice the wait."""
        late = []
        for sequence in self.in_flight:
            frame = self._in_flight[sequence]
            if now_s >= frame.due_s:
                frame.wait_s = min(2 * frame.wait_s, self._LONGEST_WAIT * self._resend_after_s)
                frame.due_s = now_s + frame.wait_s
                late.append(sequence)
        return tuple(late)

    def next_due_s(self) -> float | None:
        """When the next frame becomes overdue; None when nothing is in flight."""
        return min((frame.due_s for frame in self._in_flight.values()), default=None)

    def expire(self, now_s: float) -> None:
        """A service came back and may have missed everything: all frames are overdue, and waits start afresh."""
        for frame in self._in_flight.values():
            frame.wait_s = self._resend_after_s / 2
            frame.due_s = now_s
