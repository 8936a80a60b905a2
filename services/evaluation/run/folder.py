# SPDX-License-Identifier: Apache-2.0
"""What a run leaves in its folder, evaluated: `report.json`, `ground_truth.tum` and `plots/`."""

from collections.abc import Mapping
from pathlib import Path

from services.evaluation.run.frame_sheet import plot_frames, read_frames
from services.evaluation.run.outcome import Report, RunOutcome, ServiceUsage
from services.evaluation.run.plots import plot_density, plot_map, plot_stage_times, plot_trajectory
from services.evaluation.run.report import build_report, stage_times, write_report
from services.evaluation.run.session_log import SessionLog
from services.evaluation.run.session_reading import read_session
from services.evaluation.trajectory.alignment import Alignment
from services.evaluation.trajectory.error import TrajectoryError, trajectory_error
from services.evaluation.trajectory.files import read_trajectory
from services.formats.trajectory import Trajectory
from services.formats.tum import write_tum
from services.runtime.errors import InputError

TRAJECTORY_NAME = "trajectory.tum"
TRUTH_NAME = "ground_truth.tum"
SHEET_FRAMES = 8


def evaluate_run(
    folder: Path,
    session: Path,
    outcome: RunOutcome,
    services: Mapping[str, ServiceUsage],
    *,
    recover: bool = False,
) -> Report:
    """Evaluate a run from its recorded `session` and the trajectory.tum in `folder`; what is found goes there too.

    Raises InputError where there is no such session, or it was cut off and is not to be recovered.
    """
    _, log = read_session(session, recover=recover)
    trajectory = _exported_trajectory(folder)
    report = build_report(log, trajectory, services, outcome)
    write_report(report, folder / "report.json")
    _draw(folder, log, trajectory, report, services)
    plot_frames(read_frames(session, SHEET_FRAMES, recover=recover), folder / "plots" / "frames.png")
    return report


def _exported_trajectory(folder: Path) -> Trajectory | None:
    path = folder / TRAJECTORY_NAME
    # A run that never initialised exports a file without rows: that is a result, not bad input.
    if not path.is_file() or path.stat().st_size == 0:
        return None
    return read_trajectory(path)


def _draw(
    folder: Path, log: SessionLog, trajectory: Trajectory | None, report: Report, services: Mapping[str, ServiceUsage]
) -> None:
    plots = folder / "plots"
    plots.mkdir(exist_ok=True)
    truth = log.truth()
    if truth is not None:
        write_tum(truth, folder / TRUTH_NAME)
    if trajectory is not None:
        error = _error(trajectory, truth, report)
        plot_trajectory(trajectory, plots / "trajectory.png", truth, error)
    unit = "m" if report["scale"] == "metric" else "map units"
    plot_map(log.map_points.points(log.main_map_id()), trajectory, plots / "map.png", unit)
    plot_stage_times(stage_times(log, services), plots / "stage_times.png")
    plot_density(log.densities, plots / "density.png")


def _error(trajectory: Trajectory, truth: Trajectory | None, report: Report) -> TrajectoryError | None:
    if truth is None:
        return None
    try:
        return trajectory_error(trajectory, truth, Alignment.SIM3, frames=report["frames"]["in"])
    except InputError:
        return None  # the report already says why under `ate`
