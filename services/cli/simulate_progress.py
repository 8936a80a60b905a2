# SPDX-License-Identifier: Apache-2.0
"""Shows how far a data set is: a bar on a terminal, a line now and then elsewhere."""

import time
from collections import deque
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

from services.cli.bench.progress import duration

_PLAIN_EVERY_S = 10.0
_RATE_FRAMES = 100


class FrameProgress:
    """Frames done of all, frames a second over the last hundred, time left, the sequence at hand."""

    def __init__(self, console: Console, total: int) -> None:
        self._console, self._total = console, total
        self._rendered = 0
        self.done = 0
        self._bar: Progress | None = None
        if console.is_terminal:
            columns = (
                SpinnerColumn(),
                TextColumn("{task.completed}/{task.total} frames"),
                BarColumn(24),
                TextColumn("{task.fields[now]}"),
            )
            self._bar = Progress(*columns, console=console, refresh_per_second=4)

    def begin(self, done: int) -> None:
        """So many are there from an earlier time."""
        self.done = done
        self._started_s = time.monotonic()
        # Without the start: until the first frame is there, worlds are built.
        self._recent: deque[float] = deque(maxlen=_RATE_FRAMES)
        self._said_s = self._started_s
        if self._bar is not None:
            self._task = self._bar.add_task("frames", total=self._total, completed=done, now="building the world")
        if done:
            self._console.print(f"going on: {done} of {self._total} frames are there", highlight=False)

    def frame_done(self, sequence: str) -> None:
        """One more frame, of this sequence, is on disk."""
        self.done += 1
        self._rendered += 1
        now_s = time.monotonic()
        self._recent.append(now_s)
        now = f"{self._speed(now_s)}sequence {sequence}"
        if self._bar is not None:
            self._bar.update(self._task, completed=self.done, now=now)
        elif now_s - self._said_s >= _PLAIN_EVERY_S:
            self._said_s = now_s
            self._console.print(f"{self.done}/{self._total} frames, {now}", highlight=False, soft_wrap=True)

    def _speed(self, now_s: float) -> str:
        if len(self._recent) < 2:
            return ""
        rate = (len(self._recent) - 1) / max(now_s - self._recent[0], 1e-6)
        return f"{rate:.1f} frames/s, {duration((self._total - self.done) / rate)} left, "

    def summary(self) -> str:
        """What was done since `begin`, in a few words."""
        wall_s = max(time.monotonic() - self._started_s, 1e-6)
        return f"{self.done} frames, {self._rendered} of them rendered in {duration(wall_s)}"

    def __enter__(self) -> Self:
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()
