# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate run`: a run's folder again, or several side by side."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from services.cli.evaluate.output import print_table
from services.cli.evaluate.session import RecoverFlag
from services.cli.run_folder import CONFIG_NAME, newest_run_folder
from services.cli.run_results import USAGE_NAME, print_summary, read_usage
from services.evaluation.run.comparison import compare
from services.evaluation.run.outcome import RunOutcome
from services.runtime.config import load_config
from services.runtime.errors import InputError


def run(
    folders: Annotated[
        list[Path], typer.Argument(metavar="FOLDER...", help="Folder of a run, or several folders to compare.")
    ],
    *,
    recover: RecoverFlag = False,
) -> None:
    """A run's folder gets its report anew; several stand side by side."""
    if len(folders) > 1:
        _compare(folders)
    else:
        _evaluate_folder(folders[0], recover)


def _compare(folders: list[Path]) -> None:
    from services.evaluation.run.report import read_report

    reports = []
    for folder in folders:
        if not folder.is_dir():
            raise InputError(f"{folder}: expected the folders of runs where there is more than one path")
        reports.append(read_report(folder / "report.json"))
    print_table([folder.resolve().name for folder in folders], compare(reports))


def _evaluate_folder(given: Path, recover: bool) -> None:
    from services.evaluation.run.folder import evaluate_run
    from services.evaluation.run.report import read_report

    folder = newest_run_folder(given)
    config = load_config(folder / CONFIG_NAME)
    report_file = folder / "report.json"
    before = read_report(report_file) if report_file.is_file() else {}
    outcome = RunOutcome(
        session=before.get("session", ""),
        failure=before.get("failure", ""),
        wall_s=before.get("wall_s"),
        driven_s=before.get("driven_s"),
        every_frame=config.delivery.mode == "lossless",
    )
    usage = read_usage(folder / USAGE_NAME)
    report = evaluate_run(folder, folder / config.recorder.file, outcome, usage, recover=recover)
    print_summary(Console(markup=False), report, folder)
