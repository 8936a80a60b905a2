# SPDX-License-Identifier: Apache-2.0
"""`kinemap status`: how the services of a run are."""

from collections.abc import Iterable

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from services.cli.down import RunArgument
from services.cli.run_folder import CONFIG_NAME, newest_run_folder
from services.cli.supervision import ServiceStatus, Supervision
from services.runtime.config import load_config

_RUNNING = "running"


def status(folder: RunArgument = None) -> None:
    """One line a service: its process, since when it is up, how often it was restarted; exit code 1 if any is not."""
    run_folder = newest_run_folder(folder)
    statuses = Supervision(run_folder, load_config(run_folder / CONFIG_NAME)).status()
    console = Console()
    console.print(str(run_folder), markup=False, highlight=False, soft_wrap=True)
    console.print(status_table(statuses))
    if any(service.state != _RUNNING for service in statuses):
        raise typer.Exit(1)


def status_table(statuses: Iterable[ServiceStatus]) -> Table:
    """The table of `kinemap status`; what is wrong with a service stands in its own last line."""
    table = Table(box=None, pad_edge=False)
    for column in ("service", "state", "pid", "up", "restarts", "last words"):
        table.add_column(column, justify="right" if column in {"pid", "up", "restarts"} else "left", overflow="fold")
    for service in statuses:
        table.add_row(
            service.name,
            f"[{'green' if service.state == _RUNNING else 'red'}]{service.state}[/]",
            "-" if service.pid is None else str(service.pid),
            f"{service.uptime_s} s" if service.pid is not None else "-",
            str(service.restarts),
            escape(service.problem),
        )
    return table
