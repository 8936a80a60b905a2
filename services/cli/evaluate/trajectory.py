# SPDX-License-Identifier: Apache-2.0
"""`kinemap evaluate trajectory`: estimated trajectories against the true one, side by side."""

from pathlib import Path
from typing import Annotated

import typer

from services.cli.evaluate.output import JsonFlag, PlotsFlag, check_outputs, keep_json, print_table
from services.evaluation.trajectory.alignment import Alignment
from services.runtime.errors import InputError

_LARGEST_DIFFERENCE_S = 1e9


def trajectory(
    estimates: Annotated[
        list[Path],
        typer.Argument(
            metavar="ESTIMATE...", help="Trajectories (TUM, KITTI, EuRoC) or folders of runs, such as one a stage."
        ),
    ],
    *,
    truth: Annotated[
        Path | None, typer.Option(help="True trajectory, TUM, KITTI or EuRoC; folders of runs hold their own.")
    ] = None,
    times: Annotated[
        Path | None, typer.Option(help="Times of a KITTI trajectory, seconds, one a line (its sequence's times.txt).")
    ] = None,
    sensor: Annotated[
        Path | None, typer.Option(help="sensor.yaml of an EuRoC camera, to bring the body's true poses to it (T_BS).")
    ] = None,
    align: Annotated[
        Alignment,
        typer.Option(
            help="What may be fitted: nothing (none), rotation and translation (se3), or the scale too (sim3)."
        ),
    ] = Alignment.SIM3,
    frames: Annotated[
        int | None, typer.Option(min=1, help="Frames in the input, for the coverage (default: the true poses).")
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(help="Frames a second: where the truth is denser than the frames, or KITTI poses have no times."),
    ] = None,
    delta: Annotated[int, typer.Option(min=1, help="Frames that the relative error spans.")] = 1,
    delta_m: Annotated[float, typer.Option(help="Metres that the relative error by path spans.")] = 10.0,
    max_difference: Annotated[
        float, typer.Option(help="Seconds that poses of one moment may be apart in the two files.")
    ] = 0.01,
    json_file: JsonFlag = None,
    plots: PlotsFlag = None,
) -> None:
    """ATE, RPE and KITTI's segment errors of trajectories, each with the share of the frames it speaks of."""
    from services.evaluation.trajectory.description import describe_error
    from services.evaluation.trajectory.error import trajectory_error
    from services.evaluation.trajectory.estimates import EvaluatedTrajectory, estimate_files, recorded_truth
    from services.evaluation.trajectory.files import read_trajectory
    from services.evaluation.trajectory.table import trajectory_rows
    from services.formats.euroc import read_body_from_sensor

    if not 0.0 <= max_difference <= _LARGEST_DIFFERENCE_S:
        raise InputError(f"--max-difference {max_difference:g}: expected seconds, 0 to {_LARGEST_DIFFERENCE_S:g}")
    if times is not None and not times.is_file():
        raise InputError(f"--times {times}: no such file, expected the times of KITTI's poses, one a line")
    folder = check_outputs(json_file, plots, *estimates, truth, times, sensor)
    body_from_sensor = None if sensor is None else read_body_from_sensor(sensor)
    files = estimate_files(estimates)
    truth_file = recorded_truth(estimates) if truth is None else truth
    true = read_trajectory(truth_file, times, rate, body_from_sensor)
    evaluated = []
    for name, file in files.items():
        estimated = read_trajectory(file, times, rate)
        error = trajectory_error(
            estimated,
            true,
            align,
            frames=frames,
            rate_hz=rate,
            delta_frames=delta,
            delta_m=delta_m,
            max_difference_ns=round(max_difference * 1e9),
        )
        evaluated.append(EvaluatedTrajectory(name, estimated, error))
    print_table(list(files), trajectory_rows(evaluated))
    described = [{"name": item.name, "file": str(files[item.name]), **describe_error(item.error)} for item in evaluated]
    keep_json({"truth": str(truth_file), "estimates": described}, json_file)
    if folder is not None:
        from services.evaluation.trajectory.plots import plot_all

        plot_all(evaluated, true, folder)
