# SPDX-License-Identifier: Apache-2.0
"""`kinemap doctor`: what this machine lacks, and how to get it."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from services.cli.doctor_checks import all_checks
from services.cli.doctor_packages import Check
from services.cli.flags import ConfigFlag, resolve_config

_MARKS = {True: "[green]ok     [/green]", False: "[red]missing[/red]", None: "[cyan]note   [/cyan]"}


def doctor(
    config: ConfigFlag = None,
    folder: Annotated[Path, typer.Option(help="Where runs are to be written.")] = Path(),
) -> None:
    """Say what is missing on this machine and how to get it; exit code 1 where something is."""
    console = Console()
    resolved = resolve_config(config, None, {})
    missing = 0
    for check in all_checks(resolved, folder):
        missing += check.ok is False
        console.print(_line(check), highlight=False, soft_wrap=True)
    console.print(f"{missing} missing" if missing else "nothing is missing", highlight=False)
    if missing:
        raise typer.Exit(1)


def _line(check: Check) -> str:
    remedy = f"  ->  {check.remedy}" if check.ok is False and check.remedy else ""
    return f"{_MARKS[check.ok]} " + escape(f"{check.name}: {check.found}{remedy}")
