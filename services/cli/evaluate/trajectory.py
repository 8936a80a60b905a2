# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate trajectory`: an estimated trajectory against the true one."""

import json
from pathlib import Path
from typing import Annotated

import typer

from services.evaluation.alignment import Alignment
from services.runtime.errors import InputError


def trajectory(
    estimate: Annotated[Path, typer.Argument(metavar="ESTIMATE", help="A trajectory in TUM or KITTI format.")],
    *,
    truth: Annotated[Path | None, typer.Option(help="True trajectory, TUM or KITTI.")] = None,
    times: Annotated[
        Path | None, typer.Option(help="Times of a KITTI trajectory, seconds, one a line (its sequence's times.txt).")
    ] = None,
    align: Annotated[Alignment, typer.Option(help="What is free of the estimate's frame.")] = Alignment.SIM3,
    frames: Annotated[
        int | None, typer.Option(min=1, help="Frames in the input, for the coverage (default: the true poses).")
    ] = None,
    delta: Annotated[int, typer.Option(min=1, help="Frames that the relative error spans.")] = 1,
    plot: Annotated[Path | None, typer.Option(help="Write a picture of both trajectories (PNG).")] = None,
) -> None:
    """Errors of a trajectory, coverage beside them."""
    if truth is None:
        raise InputError(f"{estimate}: expected --truth with the true trajectory, or the folder of a run instead")
    from services.evaluation.error_description import describe_error
    from services.evaluation.trajectory_error import trajectory_error
    from services.evaluation.trajectory_files import read_trajectory

    estimated, true = read_trajectory(estimate, times=times), read_trajectory(truth, times=times)
    error = trajectory_error(estimated, true, align, frames=frames, delta_frames=delta)
    print(json.dumps(describe_error(error), indent=2))
    if plot is not None:
        from services.evaluation.plots import plot_trajectory

        plot_trajectory(estimated, plot, true, error)
