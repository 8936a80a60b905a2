# SPDX-License-Identifier: Apache-2.0
"""`realtime`: frames leave at the pace at which they were captured, a live camera's as they come."""

_CATCH_UP_S = 0.1


class Pacing:
    """Maps capture times to a monotonic clock.

    Frames that are late by more than `_CATCH_UP_S` set the clock anew: no burst makes up for them.
    """

    def __init__(self) -> None:
        self._offset_s: float | None = None

    def wait_s(self, timestamp_ns: int, now_s: float) -> float:
        """How long the frame captured at `timestamp_ns` still has to wait at `now_s`; 0 for the first and late ones."""
        captured_s = timestamp_ns / 1e9
        if self._offset_s is None or captured_s + self._offset_s < now_s - _CATCH_UP_S:
            self._offset_s = now_s - captured_s
        return max(0.0, captured_s + self._offset_s - now_s)


class AsTheyCome:
    """A live camera's frames have the right pace already."""

    def wait_s(self, timestamp_ns: int, now_s: float) -> float:
        """0."""
        return 0.0
