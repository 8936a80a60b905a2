# SPDX-License-Identifier: Apache-2.0
"""Reads or renders the next frame while the one before is on its way."""

import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from typing import Self

from services.camera.sources.source import Source, SourceFrame
from services.runtime.errors import InputError


class Prefetch:
    """The frames of `source` in order from `first` on, one read ahead in a thread of its own.

    A frame that cannot be used ends the input before it, and `failure` says why: what went before can still be
    finished like any input. An input without a first frame is none.

    `on_read_ms` hears how long each frame took, from that thread.
    """

    def __init__(self, source: Source, first: int, on_read_ms: Callable[[float], None]) -> None:
        self._source = source
        self._on_read_ms = on_read_ms
        self._index = first
        self.failure: InputError | None = None
        self._thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="read")
        self._ahead: Future[SourceFrame | None] = self._thread.submit(self._read, first)

    def has_next(self, timeout_s: float) -> bool:
        """Whether `next` returns at once, after `timeout_s` at most."""
        return not wait((self._ahead,), timeout_s).not_done

    def next(self) -> SourceFrame | None:
        """The next frame, waiting for it if need be; None at the end.

        Raises:
            InputError: there is no first frame, or it cannot be used.
        """
        try:
            frame = self._ahead.result()
            if frame is None and self._index == 0:
                raise InputError(f"input {self._source.name}: no frames, expected at least one")
        except InputError as error:
            if self._index == 0:
                raise
            self.failure = error
            return None
        if frame is not None:
            self._index += 1
            self._ahead = self._thread.submit(self._read, self._index)
        return frame

    def _read(self, index: int) -> SourceFrame | None:
        started = time.perf_counter()
        frame = self._source.frame(index)
        self._on_read_ms((time.perf_counter() - started) * 1e3)
        return frame

    def close(self) -> None:
        """Wait for the frame that is being read, and read no more."""
        self._thread.shutdown(cancel_futures=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
