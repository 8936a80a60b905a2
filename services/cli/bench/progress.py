# SPDX-License-Identifier: Apache-2.0
"""Shows how far a benchmark is: one bar over all runs on a terminal, a line a run elsewhere."""

from contextlib import AbstractContextManager, nullcontext

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

from services.cli.bench.schedule import Schedule
from services.evaluation.bench.runs import BenchRun


class BenchProgress:
    """A line for every run that has ended; on a terminal also one bar that is redrawn below them."""

    def __init__(self, console: Console, total: int) -> None:
        self._console = console
        self._total = total
        self._ended = 0
        self._bar: Progress | None = None
        if console.is_terminal:
            columns = (
                SpinnerColumn(),
                TextColumn("{task.fields[runs]} runs"),
                BarColumn(24),
                TextColumn("{task.percentage:3.0f}%  {task.fields[now]}"),
            )
            self._bar = Progress(*columns, console=console, refresh_per_second=2)
            self._task = self._bar.add_task("bench", total=total, runs=f"0/{total}", now="starting")

    def shown(self) -> AbstractContextManager[object]:
        """The bar, while entered."""
        return nullcontext() if self._bar is None else self._bar

    def on_look(self, schedule: Schedule) -> None:
        """Redraw the bar."""
        self._ended = len(schedule.done)
        if self._bar is not None:
            left = "" if schedule.left_s is None else f", {duration(schedule.left_s)} left"
            runs, now = f"{self._ended}/{self._total}", f"{schedule.current or 'done'}{left}"
            self._bar.update(self._task, completed=schedule.amount_done, runs=runs, now=now)

    def on_end(self, run: BenchRun) -> None:
        """Say how a run ended."""
        speed = run.measures.frames_per_s if run.measures is not None else None
        tail = f", {speed:.1f} frames/s" if speed is not None and not run.failure else ""
        self.say(f"{run.input} {run.variant} {run.trial} ({duration(run.wall_s)}): {run.verdict}{tail}")

    def say(self, line: str) -> None:
        """Print a line, as it is."""
        self._console.print(line, highlight=False, soft_wrap=True)


def duration(seconds: float) -> str:
    """Such as 45 s, 12 min 5 s, 3 h 20 min."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    return f"{whole // 60} min {whole % 60} s" if whole < 3600 else f"{whole // 3600} h {whole % 3600 // 60} min"
