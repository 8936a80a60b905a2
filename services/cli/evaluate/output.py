# SPDX-License-Identifier: Apache-2.0
"""How the subcommands of `kinemap evaluate` show and keep what they found."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table

from services.evaluation.run.comparison import ComparisonRow
from services.evaluation.run.outcome import Report
from services.runtime.errors import InputError, ResourceError

_LOG_WIDTH = 160
_BETWEEN = 2
"""Blanks from column to column."""
_LEAST_COLUMN = 20
"""Characters below which a column's text is not folded."""

JsonFlag = Annotated[Path | None, typer.Option("--json", help="Write everything measured to this file (JSON).")]
PlotsFlag = Annotated[Path | None, typer.Option("--plots", help="Draw the pictures into this folder (PNG).")]


def print_table(columns: Sequence[str], rows: Sequence[ComparisonRow]) -> None:
    """One column for what is measured, then one for each of `columns`; several tables where they do not fit beside
    each other. A log has no width: its lines are long."""
    console = Console(markup=False, emoji=False)
    if not console.is_terminal:
        console.width = _LOG_WIDTH
    for number, chosen in enumerate(_beside_each_other(columns, rows, console.width)):
        table = Table(box=None, pad_edge=False)
        table.add_column("", no_wrap=True)
        for column in chosen:
            table.add_column(columns[column], overflow="fold")
        for row in rows:
            table.add_row(row.what, *(row.values[column] for column in chosen))
        if number:
            console.print()
        console.print(table, highlight=False)


def _beside_each_other(columns: Sequence[str], rows: Sequence[ComparisonRow], width: int) -> list[list[int]]:
    """The columns of each table, by their places, all in order; a wide column is folded rather than left alone."""
    left = width - max((cell_len(row.what) for row in rows), default=0)
    groups: list[list[int]] = [[]]
    taken = 0
    for place, name in enumerate(columns):
        cells = [cell_len(text) for text in (name, *(row.values[place] for row in rows))]
        needed = _BETWEEN + min(max(cells), _LEAST_COLUMN)
        if groups[-1] and taken + needed > left:
            groups.append([])
            taken = 0
        groups[-1].append(place)
        taken += needed
    return groups


def check_outputs(json_file: Path | None, plots: Path | None, *inputs: Path | None) -> Path | None:
    """Make the folder of the pictures, and give it back: asked before the work, so that none of it is lost.

    Raises InputError where a file or folder of the `inputs` would be written to, or a file is where a folder is asked
    for; ResourceError where nothing can be written there.
    """
    given = [path for path in inputs if path is not None]
    if json_file is not None:
        _check_json(json_file, given)
    if plots is None:
        return None
    if plots.is_dir() and any(plots.resolve() == path.resolve() for path in given):
        raise InputError(f"--plots {plots}: is an input, expected another folder")
    return plots_folder(plots)


def keep_json(values: Report, path: Path | None) -> None:
    """Write `values` where a file was asked for. Raises ResourceError where it cannot be written."""
    from services.evaluation.run.report import write_report

    if path is None:
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_report(values, path)
    except OSError as error:
        raise ResourceError(f"--json {path}: cannot be written ({error.strerror})") from error


def plots_folder(path: Path) -> Path:
    """Make the folder. Raises InputError where there is a file, ResourceError where it cannot be made."""
    if path.exists() and not path.is_dir():
        raise InputError(f"--plots {path}: is a file, expected a folder")
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ResourceError(f"--plots {path}: cannot be made ({error.strerror})") from error
    return path


def _check_json(path: Path, inputs: Sequence[Path]) -> None:
    if path.is_dir():
        raise InputError(f"--json {path}: is a folder, expected a file")
    if path.exists():
        place = path.resolve()
        for given in inputs:
            if place == given.resolve() or given.resolve() in place.parents:
                raise InputError(f"--json {path}: is there already and belongs to the input {given}, expected another")
