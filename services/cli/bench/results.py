# SPDX-License-Identifier: Apache-2.0
"""What a benchmark ends with: tables for people and for the page, and pictures."""

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from services.evaluation.bench.runs import BenchRun
from services.evaluation.bench.table import setbacks, summary_table

_LOG_WIDTH = 160
ERRORS_NAME, TRIALS_NAME = "errors.png", "trials.png"


@dataclass(frozen=True)
class BenchOutput:
    """Where a benchmark writes, and what it says of itself. Without `table` no page is written."""

    folder: Path
    page: Path
    command: str
    label: str = ""
    table: str | None = None


def print_tables(console: Console, runs: Sequence[BenchRun]) -> None:
    """A table an input, its variants side by side, then the variants against each other, then who is not in them."""
    from services.evaluation.bench.ratios import ratio_table

    if not console.is_terminal:
        console.width = _LOG_WIDTH
    for source in dict.fromkeys(run.input for run in runs):
        summary = summary_table([run for run in runs if run.input == source], with_setbacks=False)
        table = _table([source, *(row[1] for row in summary.rows)])
        for column in range(2, len(summary.header)):
            table.add_row(summary.header[column], *(row[column] for row in summary.rows))
        console.print(table, highlight=False)
        console.print()
    ratios = ratio_table(runs)
    if ratios is not None:
        table = _table(ratios.header)
        for row in ratios.rows:
            table.add_row(*row)
        console.print(table, highlight=False)
    for run in setbacks(runs):
        console.print(f"{run.input} {run.variant} {run.trial} {run.verdict}", highlight=False, soft_wrap=True)


def draw(runs: Sequence[BenchRun], folder: Path, label: str) -> list[Path]:
    """The pictures of whatever can be drawn, in `folder`; returns them."""
    from services.evaluation.bench.paths import read_paths
    from services.evaluation.bench.plots import plot_axes, plot_errors, plot_trials

    paths = read_paths(runs, folder)
    if not paths:
        return []
    pictures = [folder / ERRORS_NAME, folder / TRIALS_NAME]
    plot_errors(runs, paths, pictures[0], label)
    plot_trials(runs, pictures[1], label)
    for source in dict.fromkeys(run.input for run in runs if run.folder in paths):
        pictures.append(folder / f"axes-{source}.png")
        plot_axes(runs, paths, source, pictures[-1], label)
    return pictures


def markdown(runs: Sequence[BenchRun], note: str = "") -> str:
    """Both tables as Markdown, and what their numbers are."""
    from services.evaluation.bench.ratios import ratio_table
    from services.evaluation.bench.runs import LEAST_COVERAGE
    from services.evaluation.measurements_page import markdown_table

    parts = [
        markdown_table(*summary_table(runs)),
        f"Medians over the runs that tracked {LEAST_COVERAGE:.0%} of their frames or more, in brackets the least and"
        " the largest. Errors are RMSE after the map's last correction; peak memory is the sum of all services' peaks.",
    ]
    ratios = ratio_table(runs)
    if ratios is not None:
        parts.append(markdown_table(*ratios))
        parts.append("Ratios are medians over pairs of runs of one seed or repeat.")
    return "\n\n".join([*parts, note] if note else parts)


def put_on_page(output: BenchOutput, name: str, runs: Sequence[BenchRun], note: str = "") -> None:
    """Both tables and `note` between `name`'s markers on the page, the picture of errors in images/ beside it."""
    from services.evaluation.measurements_page import put_table

    body = markdown(runs, note)
    picture = output.folder / ERRORS_NAME
    if picture.is_file():
        images = output.page.parent / "images"
        images.mkdir(exist_ok=True)
        shutil.copyfile(picture, images / f"{name}.png")
        body += f"\n\n![Error of every frame by input and variant](images/{name}.png)"
    put_table(output.page, name, output.command, body, title=output.label)


def _table(header: Sequence[str]) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for name in header:
        table.add_column(name, overflow="fold")
    return table
