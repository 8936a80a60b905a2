# SPDX-License-Identifier: Apache-2.0
"""`kinemap thesis odometry`: tables 5.2 and 5.3 and figures 5.15 to 5.20 of the thesis."""

import signal
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from services.cli.bench.bench_folder import bench_folder
from services.cli.bench.child_run import ProcessRunner, Runner
from services.cli.bench.drive import run_bench
from services.cli.bench.plan import BenchRequest, PlannedRun, plan_runs, stage_variants
from services.cli.bench.results import ERRORS_NAME, BenchOutput
from services.cli.flags import ConfigFlag, SetFlag
from services.cli.run import open_briefly
from services.cli.thesis.kitti_folders import parse_sequences, sequence_folders
from services.cli.thesis.output import Table, print_markdown, write_results
from services.evaluation.bench.runs import LEAST_COVERAGE, BenchRun
from services.runtime.config import Config, load_config
from services.runtime.errors import InputError, ResourceError

NAME = "odometry"
_LABEL = "KITTI odometry as in the thesis"
_MONOCULAR = "camera.stereo=false"


def odometry(
    *,
    data: Annotated[Path, typer.Option(help="Folder of KITTI odometry: sequences/NN, poses/NN.txt.")],
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder; one that was begun goes on.")],
    sequences: Annotated[str, typer.Option(help="Sequences of it.")] = "04,05,07",
    stages: Annotated[str, typer.Option(help="Stages of it.")] = "base,dynamic,moving",
    runs: Annotated[int, typer.Option(min=1, help="Trials of each stage on each sequence.")] = 5,
    frames: Annotated[int | None, typer.Option(min=1, help="Stop each run after this many frames.")] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Runs at a time.")] = 1,
    config: ConfigFlag = None,
    settings: SetFlag = None,
) -> None:
    """ATE RMSE of every trial and stage, with one camera, beside ORB-SLAM's, DynaSLAM's and the thesis' own numbers.

    A run of kinemap gives the same bytes again: trials differ by the seeds of slam and motion alone (the configured
    ones plus 0, 1, ...). The stages dynamic and moving need instance masks: SEQUENCE/instances, or what --config says.
    The same command with the same --out goes on where it was stopped.
    """
    folders = sequence_folders(data, parse_sequences(sequences), with_poses=True)
    request = BenchRequest(
        inputs=tuple(map(str, folders)),
        variants=stage_variants(stages),
        repeat=runs,
        frames=frames,
        config=config,
        settings=(_MONOCULAR, *(settings or ())),
    )
    plan = plan_runs(request)
    _open_inputs(plan)
    limit = "" if frames is None else f" --frames {frames}"
    command = f"kinemap thesis odometry --sequences {sequences} --stages {stages} --runs {runs}{limit}"
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    make_tables(plan, BenchOutput(bench_folder(out), Path(), command, _LABEL), frames, jobs)


def make_tables(
    plan: list[PlannedRun], output: BenchOutput, frames: int | None, jobs: int = 1, runner: Runner | None = None
) -> None:
    """Do the runs, then write tables and pictures of those there are, whatever ended the runs. Raises as run_bench."""
    from services.evaluation.bench.file import BENCH_NAME, read_bench

    before: BaseException | None = None
    try:
        run_bench(plan, output, runner or ProcessRunner(), Console(markup=False), jobs)
    except (InputError, ResourceError):
        raise  # nothing was run
    except BaseException as error:
        if not (output.folder / BENCH_NAME).is_file():
            raise
        before = error
    done = read_bench(output.folder).runs
    if done:
        _write(done, output.folder, frames)
        print_markdown(output.folder, NAME)
    if before is not None:
        raise before


def _open_inputs(plan: list[PlannedRun]) -> None:
    """Open each input, and the masks of each run that needs some. Raises InputError for what cannot be used."""
    for run in {(run.input, run.variant): run for run in plan}.values():
        config = load_config(None, run.configuration)
        open_briefly(config)
        if config.slam.stage != "base":
            _require_masks(run, config)


def _require_masks(run: PlannedRun, config: Config) -> None:
    from services.segmenter.no_instances import NoInstances
    from services.segmenter.service import choose_backend
    from services.segmenter.truth import TrueLabels

    backend = choose_backend(config)
    backend.close()
    if isinstance(backend, NoInstances | TrueLabels):
        raise InputError(
            f"{config.camera.input}: no instances/ for stage {run.variant}, expected masks there, or --stages base"
        )


def _write(runs: Sequence[BenchRun], folder: Path, frames: int | None) -> None:
    from services.evaluation.bench.paths import read_paths
    from services.evaluation.thesis.odometry import comparison_table, describe_odometry, stage_errors, trials_table
    from services.evaluation.thesis.odometry_plots import plot_bars, plot_top_view

    rows = stage_errors(runs)
    whole = frames is None
    parts: list[str | Table] = ["## Average error beside what was published [m]"]
    parts.append(comparison_table(rows, whole_sequences=whole))
    parts.append(
        "Means of ATE RMSE after Sim(3) alignment, one camera. "
        + (
            "Published: ORB-SLAM and DynaSLAM by Bescos et al. (RA-L 2018); the thesis' stage 1 is `dynamic`, its "
            "stage 2 `moving`."
            if whole
            else f"The first {frames} frames alone: published numbers are of whole sequences and left out."
        )
    )
    for stage in dict.fromkeys(row.stage for row in rows):
        parts += [f"## Stage `{stage}`, trial by trial [m]", trials_table(rows, stage)]
    parts.append(
        "Trials differ by the seeds of slam and motion alone; equal seeds give equal bytes. A trial that tracked less "
        f"than {LEAST_COVERAGE:.0%} of its frames is lost and not in the average."
    )
    plot_bars(rows, folder / "bars.png", whole_sequences=whole)
    parts.append("![mean errors (figure 5.15)](bars.png)")
    paths = read_paths(runs, folder)
    for sequence in dict.fromkeys(row.sequence for row in rows):
        if plot_top_view(rows, paths, sequence, folder / f"top-{sequence}.png"):
            parts.append(f"![{sequence} from above (figures 5.16, 5.18)](top-{sequence}.png)")
            parts.append(f"![{sequence} by axis (figure 5.19)](axes-{sequence}.png)")
    if paths:
        parts.append(f"![error of every frame (figure 5.20)]({ERRORS_NAME})")
    write_results(folder, NAME, _LABEL, parts, describe_odometry(rows, frames=frames))
