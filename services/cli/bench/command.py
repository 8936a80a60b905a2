# SPDX-License-Identifier: Apache-2.0
"""`kinemap bench`: the stages, or any configurations, side by side over seeds and sequences."""

import shlex
import signal
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from services.cli.bench.bench_folder import bench_folder
from services.cli.bench.child_run import ProcessRunner
from services.cli.bench.drive import run_bench
from services.cli.bench.plan import (
    SIMULATOR,
    STAGES,
    BenchRequest,
    PlannedRun,
    parse_seeds,
    parse_variant,
    plan_runs,
    stage_variants,
)
from services.cli.bench.results import BenchOutput
from services.cli.flags import ConfigFlag, SetFlag
from services.cli.run import open_briefly
from services.evaluation.measurements_page import check_page
from services.runtime.config import load_config
from services.runtime.errors import InputError

DEFAULT_PAGE = Path("docs/measurements.md")


def bench(
    inputs: Annotated[
        list[str] | None,
        typer.Argument(metavar="[INPUT]", help="What `kinemap run` takes, several (default: 'simulator')."),
    ] = None,
    *,
    stages: Annotated[
        str | None, typer.Option(help=f"Stages to compare (default: {','.join(STAGES)}, or none beside --variant).")
    ] = None,
    variant: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME:SECTION.FIELD=VALUE[,...]", help="Another configuration to compare; repeatable."),
    ] = None,
    seeds: Annotated[str | None, typer.Option(help="Seeds of the simulator, such as 7,13,14.")] = None,
    repeat: Annotated[
        int,
        typer.Option(min=1, help="Runs of each input (or seed), with other random samples in slam and motion."),
    ] = 1,
    frames: Annotated[int | None, typer.Option("--frames", help="Stop each run after this many frames.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Runs at a time; with more than 1 no speed is shown.")] = 1,
    label: Annotated[str, typer.Option(help="Title of tables and pictures.")] = "",
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", help="Folder; one that was begun goes on (default: runs/bench-<time>)"),
    ] = None,
    page: Annotated[Path | None, typer.Option(help=f"Markdown page for --table (default: {DEFAULT_PAGE}).")] = None,
    table: Annotated[
        str | None, typer.Option(metavar="NAME", help="Put the table on the page, between the markers of that name.")
    ] = None,
    config: ConfigFlag = None,
    settings: SetFlag = None,
) -> None:
    """Run every INPUT in every stage (or variant), with every seed, and set the results side by side.

    Each run keeps its folder in --out. The same command with the same --out goes on where it was stopped: a run that
    went through is not run again. Exit code 1 where a run failed; the others are done all the same.
    """
    named = tuple(parse_variant(text) for text in variant or ())
    request = BenchRequest(
        inputs=tuple(inputs or (SIMULATOR,)),
        variants=(() if stages is None and named else stage_variants(",".join(STAGES) if stages is None else stages))
        + named,
        seeds=parse_seeds(seeds) if seeds is not None else (),
        repeat=repeat,
        frames=frames,
        config=config,
        settings=tuple(settings or ()),
    )
    if not label.isprintable() or "<!--" in label:
        raise InputError(f"--label {label!r}: expected one line of text without a comment of Markdown (<!--)")
    if page is not None and table is None:
        raise InputError(f"--page {page}: expected --table with the name of the table on it")
    if table is not None:
        check_page(page or DEFAULT_PAGE, table)
    plan = plan_runs(request)
    options = {
        "stages": stages,
        "variant": variant,
        "seeds": seeds,
        "repeat": repeat if repeat > 1 else None,
        "frames": frames,
        "config": config,
        "set": settings,
        "label": label,
        "table": table,
    }
    command = _command(request.inputs, options)
    output = BenchOutput(bench_folder(out), page or DEFAULT_PAGE, command, label, table)
    _open_inputs(plan)
    # Whoever ends this process politely means all its runs.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    run_bench(plan, output, ProcessRunner(), Console(markup=False), jobs)


def _open_inputs(plan: list[PlannedRun]) -> None:
    """Open each input once, as its runs will. Raises InputError for one that cannot be used."""
    for run in {run.input: run for run in plan}.values():
        try:
            open_briefly(load_config(None, run.configuration))
        except OSError as error:
            raise InputError(f"input {run.input}: cannot be opened ({error.strerror or error})") from error


def _command(inputs: Sequence[str], options: Mapping[str, object]) -> str:
    """The command as the page shows it: inputs by their names alone, for where they lie is of this machine."""
    words = [source if source == SIMULATOR else Path(source).resolve().name for source in inputs]
    for name, value in options.items():
        for one in value if isinstance(value, list) else [value]:
            if one not in (None, ""):
                words += [f"--{name}", one.name if isinstance(one, Path) else str(one)]
    return " ".join(["kinemap bench", *map(shlex.quote, words)])
