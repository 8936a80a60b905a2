# SPDX-License-Identifier: Apache-2.0
"""The recorded session of what the user names as a run."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.run_folder import CONFIG_NAME, newest_run_folder
from services.runtime.config import load_config

RecoverFlag = Annotated[bool, typer.Option("--recover", help="Read what is whole of a recording that was cut off.")]


def session_of(run: Path) -> Path:
    """The session that a run's folder holds; another path is taken as a session itself.

    Raises InputError for a folder that no run has written to.
    """
    if not run.is_dir():
        return run
    folder = newest_run_folder(run)
    return folder / load_config(folder / CONFIG_NAME).recorder.file
