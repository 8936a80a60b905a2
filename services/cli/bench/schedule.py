# SPDX-License-Identifier: Apache-2.0
"""The order of a benchmark: which runs there are already, which go on, which come next."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from services.cli.bench.child_run import RunEnd, Runner, RunningRun
from services.cli.bench.kept_runs import KeptRuns
from services.cli.bench.plan import PlannedRun
from services.evaluation.bench.runs import BenchRun

_LOOK_EVERY_S = 0.5


@dataclass
class Schedule:
    """Does the runs, `jobs` at a time. After each look at them it calls `on_look`, after each that ended `on_end`."""

    runs: Sequence[PlannedRun]
    kept: KeptRuns
    runner: Runner
    jobs: int = 1
    on_look: Callable[["Schedule"], None] = lambda _: None
    on_end: Callable[[BenchRun], None] = lambda _: None
    clock: Callable[[], float] = time.monotonic
    done: dict[int, BenchRun] = field(default_factory=dict)
    """by the number of the run in `runs`"""
    reused: int = 0
    """of those, the ones that were there already"""
    running: dict[int, RunningRun] = field(default_factory=dict)
    _began_s: float = 0.0

    def recall(self) -> None:
        """Take what is there already. Raises InputError where a kept run was configured otherwise."""
        for number, run in enumerate(self.runs):
            if (kept := self.kept.finished(run)) is not None:
                self.done[number] = kept
        self.reused = len(self.done)

    def drive(self) -> None:
        """Do what is left. Whatever ends it, Ctrl-C too, no run is left running; `done` holds those that had ended."""
        waiting = [number for number in range(len(self.runs)) if number not in self.done]
        self._began_s = self.clock()
        try:
            while waiting or self.running:
                while waiting and len(self.running) < self.jobs:
                    self._start(waiting.pop(0))
                self._look()
                self.on_look(self)
        finally:
            for number, run in self.running.items():
                run.stop()
                # What was stopped has no numbers to compare; the next time it is done from its beginning.
                self.kept.clear(self.runs[number])

    @property
    def bench_runs(self) -> list[BenchRun]:
        """The runs that have ended, in the order of the plan."""
        return [self.done[number] for number in sorted(self.done)]

    @property
    def amount_done(self) -> float:
        """In runs; a run that goes on counts by its share."""
        return len(self.done) + sum(run.share_done() for run in self.running.values())

    @property
    def left_s(self) -> float | None:
        """Seconds to the end, if all goes on as it went so far; None where nothing is known yet."""
        amount, elapsed_s = self.amount_done - self.reused, self.clock() - self._began_s
        return elapsed_s / amount * (len(self.runs) - self.amount_done) if amount > 0.0 else None

    @property
    def current(self) -> str:
        """The runs that go on."""
        return ", ".join(self.runs[number].name for number in self.running)

    def _start(self, number: int) -> None:
        run = self.runs[number]
        self.kept.clear(run)
        self.running[number] = self.runner.start(run, self.kept.folder / run.folder)

    def _look(self) -> None:
        timeout_s = _LOOK_EVERY_S
        for number, run in list(self.running.items()):
            end = run.wait(timeout_s)
            timeout_s = 0.0
            if end is not None:
                self._end(number, end)

    def _end(self, number: int, end: RunEnd) -> None:
        del self.running[number]
        self.done[number] = self.kept.keep(self.runs[number], end, alone=self.jobs == 1)
        self.on_end(self.done[number])
