# SPDX-License-Identifier: Apache-2.0
"""`kinemap down`: stop what `kinemap up` started."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from services.cli.run_folder import CONFIG_NAME, newest_run_folder
from services.cli.run_results import export_results
from services.cli.supervision import Supervision
from services.runtime.config import load_config

RunArgument = Annotated[Path | None, typer.Argument(metavar="[RUN]", help="Folder of the run (default: the newest).")]


def down(folder: RunArgument = None) -> None:
    """Let the services finish what has arrived, stop them, and export trajectory and map."""
    run_folder = newest_run_folder(folder)
    config = load_config(run_folder / CONFIG_NAME)
    Supervision(run_folder, config).down()
    export_results(config)
    Console(markup=False).print(f"down: {run_folder}", highlight=False, soft_wrap=True)
