# SPDX-License-Identifier: Apache-2.0
"""Pictures of trajectories side by side: seen from above, along the axes, and their errors (thesis 5.19 and 5.20)."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from services.evaluation.pictures.figure import finish_top_view, new_figure, save_figure, shown_name
from services.evaluation.trajectory.estimates import EvaluatedTrajectory
from services.evaluation.trajectory.ground_plane import ground_plane
from services.formats.trajectory import Trajectory

COLOURS = ("#1f77b4", "#d62728", "#2e8b57", "#9467bd", "#e0a800", "#8c564b", "#e377c2", "#17becf")
_GAP = 1.5
"""where poses are farther apart than so many usual steps, tracking was lost: no line is drawn across"""

Floats = npt.NDArray[np.float64]


def plot_all(evaluated: Sequence[EvaluatedTrajectory], truth: Trajectory, folder: Path) -> list[Path]:
    """Draw the four pictures into `folder`, which exists."""
    pictures = {
        "trajectory.png": plot_paths,
        "xyz.png": plot_axes,
        "error_violin.png": plot_error_violin,
        "error_over_time.png": plot_error_over_time,
    }
    for name, plot in pictures.items():
        plot(evaluated, truth, folder / name)
    return [folder / name for name in pictures]


def plot_paths(evaluated: Sequence[EvaluatedTrajectory], truth: Trajectory, path: Path) -> None:
    """Top view of the truth and of every estimate, aligned."""
    figure = new_figure()
    axes = figure.add_subplot()
    plane = ground_plane(truth.world_from_camera)
    axes.plot(*plane.project(truth.positions_m).T, color="black", linewidth=2.5, label="ground truth", zorder=1)
    axes.plot(*plane.project(truth.positions_m[:1]).T, "o", color="black", label="start", zorder=3)
    for number, item in enumerate(evaluated):
        _, positions = _broken_at_gaps(_seconds(item.trajectory, truth), _aligned_positions(item))
        axes.plot(*plane.project(positions).T, color=_colour(number), linewidth=1.2, label=_label(item), zorder=2)
    axes.set_title("trajectories, seen from above")
    finish_top_view(axes, plane, "m")
    save_figure(figure, path)


def plot_axes(evaluated: Sequence[EvaluatedTrajectory], truth: Trajectory, path: Path) -> None:
    """x, y and z in the truth's frame over time (thesis figure 5.19)."""
    figure = new_figure()
    rows = figure.subplots(3, 1, sharex=True)
    for axis, (axes, name) in enumerate(zip(rows, "xyz", strict=True)):
        axes.plot(
            _seconds(truth, truth), truth.positions_m[:, axis], color="black", linewidth=2.5, label="ground truth"
        )
        for number, item in enumerate(evaluated):
            seconds, positions = _broken_at_gaps(_seconds(item.trajectory, truth), _aligned_positions(item))
            axes.plot(seconds, positions[:, axis], color=_colour(number), linewidth=1.2, label=_label(item))
        axes.set_ylabel(f"{name} [m]")
        axes.grid(visible=True, linewidth=0.3)
    rows[0].legend(loc="best", fontsize=8)
    rows[0].set_title("position along each axis")
    rows[2].set_xlabel("time [s]")
    save_figure(figure, path)


def plot_error_violin(evaluated: Sequence[EvaluatedTrajectory], truth: Trajectory, path: Path) -> None:
    """How the absolute error of every pose is spread, one violin an estimate (thesis figure 5.20)."""
    figure = new_figure(height_in=5.5, width_in=max(6.0, 1.6 * len(evaluated) + 2.0))
    axes = figure.add_subplot()
    places = np.arange(1, len(evaluated) + 1)
    errors = [item.error.errors_m for item in evaluated]
    parts: dict[str, Any] = axes.violinplot(errors, places, widths=0.7, showextrema=False)
    for number, item in enumerate(evaluated):
        parts["bodies"][number].set(facecolor=_colour(number), edgecolor="black", alpha=0.6)
        low, median, high = np.percentile(item.error.errors_m, (25, 50, 75))
        axes.vlines(number + 1, low, high, color="black", linewidth=4)
        axes.plot(number + 1, median, "o", color="white", markeredgecolor="black", markersize=6)
    axes.set_xticks(places, [_label(item, "\n") for item in evaluated], fontsize=8)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("absolute error of a pose [m]")
    axes.set_title(f"error against {shown_name(Path(truth.name).name)}: spread, quartiles and median")
    axes.grid(visible=True, axis="y", linewidth=0.3)
    save_figure(figure, path)


def plot_error_over_time(evaluated: Sequence[EvaluatedTrajectory], truth: Trajectory, path: Path) -> None:
    """The absolute error of every pose over time."""
    figure = new_figure(height_in=4.0)
    axes = figure.add_subplot()
    for number, item in enumerate(evaluated):
        seconds = _seconds(item.trajectory, truth)[item.error.matches.estimate_index]
        seconds, errors = _broken_at_gaps(seconds, item.error.errors_m[:, None])
        axes.plot(seconds, errors[:, 0], color=_colour(number), linewidth=1.2, label=_label(item))
    axes.set_xlim(0.0, float(_seconds(truth, truth)[-1]))
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("absolute error [m]")
    axes.set_title("error over time")
    axes.grid(visible=True, linewidth=0.3)
    axes.legend(loc="best", fontsize=8)
    save_figure(figure, path)


def _label(item: EvaluatedTrajectory, between: str = ": ") -> str:
    ate = f"ATE {item.error.absolute_m.rmse:.3f} m ({item.error.alignment.value}), {item.error.coverage:.1%}"
    return f"{shown_name(item.name)}{between}{ate}"


def _colour(number: int) -> str:
    return COLOURS[number % len(COLOURS)]


def _seconds(trajectory: Trajectory, truth: Trajectory) -> Floats:
    seconds: Floats = (trajectory.timestamp_ns - truth.timestamp_ns[0]) / 1e9
    return seconds


def _aligned_positions(item: EvaluatedTrajectory) -> Floats:
    return item.error.truth_from_estimate.points(item.trajectory.positions_m)


def _broken_at_gaps(seconds: Floats, values: Floats) -> tuple[Floats, Floats]:
    steps = np.diff(seconds)
    after = np.flatnonzero(steps > _GAP * np.median(steps)) + 1
    return np.insert(seconds, after, np.nan), np.insert(values, after, np.nan, axis=0)
