# SPDX-License-Identifier: Apache-2.0
"""Shows a RunProgress: one bar on a terminal, a plain line now and then elsewhere."""

from types import TracebackType
from typing import Protocol, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, SpinnerColumn, Task, TextColumn
from rich.text import Text

from services.cli.run_progress import RunProgress

_PLAIN_EVERY_S = 5.0

_STATE_STYLE = {"tracking": "green", "lost": "red", "initializing": "yellow"}
_LABEL_STYLE = {"static": "green", "moving": "red"}
_DENSITY_STYLE = {"low": "green", "high": "red"}


class ProgressView(Protocol):
    """Something that shows progress while it is entered."""

    def show(self, progress: RunProgress, now_s: float) -> None:
        """Show it as it stands."""

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...


def progress_view(console: Console) -> ProgressView:
    """A bar where `console` is a terminal, else plain lines."""
    return ProgressBar(console) if console.is_terminal else ProgressLines(console)


class _NowColumn(ProgressColumn):
    """Frames a second, tracking state, landmarks by label and density, coloured as in the plots."""

    def render(self, task: Task) -> Text:
        progress: RunProgress = task.fields["progress"]
        text = Text(f"{progress.frames_per_s:5.1f} fps  ")
        text.append(progress.state, _STATE_STYLE.get(progress.state, ""))
        text.append("  landmarks")
        counts = {label: count for label, count in progress.landmarks.items() if count}
        for label, count in counts.items():
            text.append(f" {count} {label.replace('_', ' ')}", _LABEL_STYLE.get(label, "yellow"))
        text.append("" if counts else " none")
        text.append("  density ")
        text.append(progress.density, _DENSITY_STYLE.get(progress.density, ""))
        return text


class ProgressBar:
    """One bar that is redrawn in place."""

    def __init__(self, console: Console) -> None:
        columns = (
            SpinnerColumn(),
            TextColumn("{task.completed}/{task.fields[total_text]}"),
            BarColumn(24),
            _NowColumn(),
        )
        self._progress = Progress(*columns, console=console, refresh_per_second=4)
        self._task = self._progress.add_task("run", total=None, total_text="?", progress=RunProgress())

    def show(self, progress: RunProgress, now_s: float) -> None:
        """Redraw."""
        known = progress.total >= 0
        self._progress.update(
            self._task,
            completed=progress.frames,
            total=progress.total if known else None,
            total_text=str(progress.total) if known else "?",
            progress=progress,
        )

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()


class ProgressLines:
    """A line every few seconds, for logs."""

    def __init__(self, console: Console, every_s: float = _PLAIN_EVERY_S) -> None:
        self._console = console
        self._every_s = every_s
        self._next_s: float | None = None
        self._said = ""

    def show(self, progress: RunProgress, now_s: float) -> None:
        """Print, when it is time."""
        if self._next_s is None:
            self._next_s = now_s + self._every_s
        if now_s >= self._next_s:
            self._next_s = now_s + self._every_s
            self._say(progress.line())

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._next_s = None

    def _say(self, line: str) -> None:
        if line != self._said:
            self._said = line
            self._console.print(line, highlight=False, soft_wrap=True)
