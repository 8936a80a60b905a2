# SPDX-License-Identifier: Apache-2.0
"""Which frames are segmented when not all are: masks of the others are carried along the optical flow."""

import math

_LOAD = 0.8
"""of the time between two frames that segmenting may take, in the mean"""
_MEMORY = 0.8
"""how much of a mean is kept when a new duration comes in"""
_MOST = 30


class EveryNth:
    """Every nth frame by its number: a frame that comes again gets the same answer (lossless)."""

    def __init__(self, every: int) -> None:
        self._every = every

    def is_due(self, sequence: int, timestamp_ns: int) -> bool:
        """Whether this frame is to be segmented."""
        return sequence % self._every == 0

    def took(self, duration_ns: int) -> None:
        """How long a frame took; changes nothing."""

    @property
    def every(self) -> int:
        """Frames from one that is segmented to the next."""
        return self._every


class AsOftenAsPossible:
    """As many frames as there is time for: the interval follows the camera's rate and what a frame takes (realtime)."""

    def __init__(self) -> None:
        self._last_ns: int | None = None
        self._last_due = -_MOST
        self._period_ns = 0.0
        self._duration_ns = 0.0
        self._last_sequence = 0

    def is_due(self, sequence: int, timestamp_ns: int) -> bool:
        """Whether this frame is to be segmented; also counts it."""
        if self._last_ns is not None and sequence > self._last_sequence and timestamp_ns > self._last_ns:
            # frames that were dropped on the way count as frames
            period = (timestamp_ns - self._last_ns) / (sequence - self._last_sequence)
            self._period_ns = _mean(self._period_ns, period)
        self._last_ns, self._last_sequence = timestamp_ns, sequence
        due = sequence - self._last_due >= self.every or sequence < self._last_due
        if due:
            self._last_due = sequence
        return due

    def took(self, duration_ns: int) -> None:
        """How long the frame that was due took."""
        self._duration_ns = _mean(self._duration_ns, duration_ns)

    @property
    def every(self) -> int:
        """Frames from one that is segmented to the next."""
        if not self._period_ns or not self._duration_ns:
            return 1
        return min(_MOST, max(1, math.ceil(self._duration_ns / (_LOAD * self._period_ns))))


def _mean(before: float, value: float) -> float:
    return _MEMORY * before + (1 - _MEMORY) * value if before else value
