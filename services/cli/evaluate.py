# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate`: a run's folder again, or any trajectory against the truth."""

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from services.cli.run_folder import CONFIG_NAME, newest_run_folder
from services.cli.run_results import USAGE_NAME, print_summary, read_usage
from services.evaluation.alignment import Alignment
from services.evaluation.comparison import compare
from services.evaluation.run_outcome import RunOutcome
from services.runtime.config import load_config
from services.runtime.errors import InputError


def evaluate(
    paths: Annotated[
        list[Path],
        typer.Argument(
            metavar="PATH...",
            help="Folder of a run, a trajectory in TUM or KITTI format, or several folders to compare.",
        ),
    ],
    *,
    truth: Annotated[
        Path | None, typer.Option(help="True trajectory, TUM or KITTI; a run's folder holds its own.")
    ] = None,
    times: Annotated[
        Path | None, typer.Option(help="Times of a KITTI trajectory, seconds, one a line (its sequence's times.txt).")
    ] = None,
    align: Annotated[Alignment, typer.Option(help="What is free of the estimate's frame.")] = Alignment.SIM3,
    frames: Annotated[
        int | None, typer.Option(min=1, help="Frames in the input, for the coverage (default: the true poses).")
    ] = None,
    delta: Annotated[int, typer.Option(min=1, help="Frames that the relative error spans.")] = 1,
    plot: Annotated[Path | None, typer.Option(help="Write a picture of both trajectories (PNG).")] = None,
    recover: Annotated[
        bool, typer.Option("--recover", help="Read what is whole of a recording that was cut off.")
    ] = False,
) -> None:
    """Errors of a trajectory, coverage beside them; a run's folder gets its report anew; several stand side by side."""
    if len(paths) > 1:
        _compare(paths)
        return
    estimate = paths[0]
    if estimate.is_dir():
        if truth is not None:
            raise InputError(f"--truth {truth}: a run's folder holds its own truth, expected a trajectory file with it")
        _evaluate_folder(estimate, recover)
        return
    if truth is None:
        raise InputError(f"{estimate}: expected --truth with the true trajectory, or the folder of a run instead")
    from services.evaluation.report import describe_error
    from services.evaluation.trajectory_error import trajectory_error
    from services.evaluation.trajectory_files import read_trajectory

    estimated, true = read_trajectory(estimate, times=times), read_trajectory(truth, times=times)
    error = trajectory_error(estimated, true, align, frames=frames, delta_frames=delta)
    print(json.dumps(describe_error(error), indent=2))
    if plot is not None:
        from services.evaluation.plots import plot_trajectory

        plot_trajectory(estimated, plot, true, error)


def _compare(folders: list[Path]) -> None:
    from services.evaluation.report import read_report

    reports = []
    for folder in folders:
        if not folder.is_dir():
            raise InputError(f"{folder}: expected the folders of runs where there is more than one path")
        reports.append(read_report(folder / "report.json"))
    table = Table(box=None, pad_edge=False)
    for name in ("", *(folder.resolve().name for folder in folders)):
        table.add_column(name, overflow="fold")
    for row in compare(reports):
        table.add_row(row.what, *row.values)
    Console(markup=False).print(table, highlight=False)


def _evaluate_folder(given: Path, recover: bool) -> None:
    from services.evaluation.report import read_report
    from services.evaluation.run_folder import evaluate_run

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
