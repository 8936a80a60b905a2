# SPDX-License-Identifier: Apache-2.0
"""A benchmark from its plan to its tables."""

from collections.abc import Sequence
from dataclasses import replace

from rich.console import Console

from services.cli.bench.bench_folder import reserved
from services.cli.bench.child_run import Runner
from services.cli.bench.kept_runs import KeptRuns
from services.cli.bench.plan import PlannedRun
from services.cli.bench.progress import BenchProgress
from services.cli.bench.results import BenchOutput, draw, print_tables, put_on_page
from services.cli.bench.schedule import Schedule
from services.evaluation.bench.file import Bench, write_bench
from services.evaluation.bench.runs import BenchRun, RunStatus
from services.evaluation.measurements_page import machine
from services.runtime.errors import KinemapError


class FailedRunsError(KinemapError):
    """The benchmark is done, and not every run of it went through."""


class InterruptedBenchError(KinemapError):
    """The user ended the benchmark."""

    exit_code = 130


def run_bench(plan: list[PlannedRun], output: BenchOutput, runner: Runner, console: Console, jobs: int = 1) -> None:
    """Do the runs of the plan that are not there yet, then write bench.json, tables, pictures and the page.

    Raises:
        InputError: a kept run was configured otherwise, or the folder is in use; nothing has been run.
        FailedRunsError: some runs failed; everything has been written all the same.
        InterruptedBenchError: the user ended it; all but the page has been written of the runs that had ended.
    """
    with reserved(output.folder):
        kept = KeptRuns(output.folder)
        progress = BenchProgress(console, len(plan))

        def keep(run: BenchRun | None) -> None:
            if run is not None:
                progress.on_end(run)
            runs = schedule.bench_runs
            write_bench(Bench(output.command, output.label, machine(), len(plan), runs), output.folder)

        schedule = Schedule(plan, kept, runner, jobs, progress.on_look, keep)
        schedule.recall()
        keep(None)
        if schedule.done:
            progress.say(f"{len(schedule.done)} of {len(plan)} runs are there already")
        interrupted = False
        try:
            with progress.shown():
                schedule.drive()
        except KeyboardInterrupt:
            interrupted = True
        _finish(schedule, output, console, interrupted)


def _finish(schedule: Schedule, output: BenchOutput, console: Console, interrupted: bool) -> None:
    runs, folder = schedule.bench_runs, output.folder
    if runs:
        draw(runs, folder, output.label)
        print_tables(console, runs)
        console.print(f"folder {folder}", highlight=False, soft_wrap=True)
    other = sum(schedule.kept.made_by_other_code(run) for run in schedule.runs)
    note = f"{other} of these runs are of an earlier state of the program." if other else ""
    if note:
        console.print(f"{note} Another --out runs them anew.", highlight=False, soft_wrap=True)
    if interrupted:
        raise InterruptedBenchError(f"stopped by the user after {len(runs)} of {len(schedule.runs)} runs")
    if output.table is not None:
        put_on_page(output, output.table, _without_paths(runs, schedule.runs), note)
    failed = sum(run.status is RunStatus.FAILED for run in runs)
    if failed:
        raise FailedRunsError(f"{failed} of {len(runs)} runs failed; see the logs beside their folders in {folder}")


def _without_paths(runs: Sequence[BenchRun], plan: Sequence[PlannedRun]) -> list[BenchRun]:
    # A page is for readers elsewhere: where the inputs lie is of this machine.
    names = {run.configuration["camera"]["input"]: run.input for run in plan}
    shown = []
    for run in runs:
        failure = run.failure
        for path, name in names.items():
            failure = failure.replace(path, name)
        shown.append(replace(run, failure=failure))
    return shown
