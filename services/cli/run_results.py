# SPDX-License-Identifier: Apache-2.0
"""What a run ends with: trajectory, map, report, plots, and a summary for people."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.table import Table

from services.evaluation.run.outcome import Report, RunOutcome, ServiceUsage
from services.evaluation.run.summary import summary_rows
from services.runtime.config import Config
from services.runtime.errors import InputError

MAP_NAME = "map.sqlite"
USAGE_NAME = "services.json"
_LOG_WIDTH = 160
DEFAULT_FORMATS = ("tum", "pcd")


def map_path(config: Config) -> Path:
    """The database that the run's mapstore fills."""
    return config.mapstore.database or config.run.out / MAP_NAME


def export_results(config: Config) -> None:
    """trajectory.tum, keyframes.tum and map.pcd from the run's map, where there is one."""
    from services.mapstore.export import export_map

    if map_path(config).is_file():
        export_map(map_path(config), config.run.out, DEFAULT_FORMATS)


def report_results(
    config: Config, outcome: RunOutcome, services: Mapping[str, ServiceUsage], recover: bool
) -> Report | None:
    """report.json and plots/; None where the run ended before anything was recorded."""
    from services.evaluation.run.folder import evaluate_run

    folder = config.run.out
    if services:
        write_usage(services, folder / USAGE_NAME)
    session = folder / config.recorder.file
    return evaluate_run(folder, session, outcome, services, recover=recover) if session.is_file() else None


def write_usage(services: Mapping[str, ServiceUsage], path: Path) -> None:
    """Keep what the heartbeats said, which no recording holds, for a later `kinemap evaluate`."""
    rows = {name: asdict(usage) for name, usage in services.items()}
    path.write_text(json.dumps(rows, indent=2, sort_keys=True) + "\n", encoding="utf-8")


def read_usage(path: Path) -> dict[str, ServiceUsage]:
    """What `write_usage` kept; empty where it kept nothing. Raises InputError for another file."""
    if not path.is_file():
        return {}
    try:
        return {name: ServiceUsage(**row) for name, row in json.loads(path.read_text(encoding="utf-8")).items()}
    except (ValueError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: not what a run keeps of its services ({error})") from None


def saved_map_row(path: Path, began_s: float) -> tuple[str, str]:
    """What the summary says of the file of --save-map, after a run that began at `began_s` of the system's clock."""
    # A file's time lags some milliseconds behind the clock.
    if not path.is_file() or path.stat().st_mtime < began_s - 1:
        return "map saved", f"none: {path} was not written"
    return "map saved", f"{path}  (to begin in it: --map {path})"


def print_summary(console: Console, report: Report, folder: Path, *more: tuple[str, str]) -> None:
    """The summary as a table, with `more` rows; in a log, which has no width, in long lines."""
    if not console.is_terminal:
        console.width = _LOG_WIDTH
    table = Table(show_header=False, box=None, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for what, value in (*summary_rows(report), *more):
        table.add_row(what, value)
    table.add_row("folder", str(folder))
    console.print(table, highlight=False)
