# SPDX-License-Identifier: Apache-2.0
"""Pictures of a run, as PNG files. Drawn with Agg: no display is needed."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes

from schemas.records import Density, DensityLevel, MotionState
from services.evaluation.map.points import Points
from services.evaluation.pictures.figure import finish_top_view, new_figure, save_figure
from services.evaluation.trajectory.error import TrajectoryError
from services.evaluation.trajectory.ground_plane import ground_plane
from services.formats.trajectory import Trajectory

STATE_COLOURS: dict[MotionState, str] = {
    MotionState.STATIC: "#2e8b57",
    MotionState.NON_MOVING: "#e0a800",
    MotionState.UNDECIDED: "#e0a800",
    MotionState.POTENTIALLY_DYNAMIC: "#e0a800",
    MotionState.MOVING: "#d62728",
}
"""Green: background; yellow: an object that stands or may move; red: moving."""

_LEVEL_COLOURS = {DensityLevel.UNKNOWN: "#999999", DensityLevel.LOW: "#2e8b57", DensityLevel.HIGH: "#d62728"}

# A badly triangulated point can be kilometres away and would shrink the street to a dot: the view holds the path and
# all but a few percent of the points, and reaches no farther from the path than a share of the path's own extent.
_OUTLIERS = 2.0
_FARTHEST = 0.4
_MARGIN = 0.05


def plot_trajectory(
    estimate: Trajectory, path: Path, truth: Trajectory | None = None, error: TrajectoryError | None = None
) -> None:
    """Top view of the estimate, brought onto the truth where there is one."""
    figure = new_figure()
    axes = figure.add_subplot()
    poses = estimate.world_from_camera if error is None else error.truth_from_estimate.poses(estimate.world_from_camera)
    plane = ground_plane(truth.world_from_camera if truth is not None else poses)
    unit = "m" if error is not None else "map units"
    if truth is not None:
        axes.plot(*plane.project(truth.positions_m).T, color="black", linewidth=2.5, label="ground truth", zorder=1)
    estimated = plane.project(poses[:, :3, 3])
    axes.plot(*estimated.T, color="#1f77b4", linewidth=1.2, label="kinemap", zorder=2)
    axes.plot(*estimated[0], marker="o", color="#1f77b4", label="start", linestyle="none", zorder=3)
    if error is None:
        axes.set_title("trajectory" if truth is None else "trajectory (could not be aligned to the ground truth)")
    else:
        covered = f"{error.coverage:.1%} of {error.frames} frames"
        axes.set_title(f"ATE RMSE {error.absolute_m.rmse:.3f} m ({error.alignment.value}), {covered}")
    finish_top_view(axes, plane, unit)
    save_figure(figure, path)


def plot_map(points: Points, trajectory: Trajectory | None, path: Path, unit: str = "map units") -> None:
    """Top view of the map in green, yellow and red, with the camera's path."""
    figure = new_figure()
    axes = figure.add_subplot()
    plane = ground_plane(trajectory.world_from_camera if trajectory is not None else np.eye(4)[None])
    projected = plane.project(points.position)
    for state, colour, label in (
        ((MotionState.STATIC,), STATE_COLOURS[MotionState.STATIC], "static"),
        (
            (MotionState.NON_MOVING, MotionState.UNDECIDED, MotionState.POTENTIALLY_DYNAMIC),
            STATE_COLOURS[MotionState.NON_MOVING],
            "standing or undecided",
        ),
        ((MotionState.MOVING,), STATE_COLOURS[MotionState.MOVING], "moving"),
    ):
        chosen = np.isin(points.state, state)
        axes.scatter(
            projected[chosen, 0],
            projected[chosen, 1],
            s=2,
            color=colour,
            linewidths=0,
            label=f"{label} ({int(chosen.sum())})",
        )
    if trajectory is not None:
        path_in_plane = plane.project(trajectory.positions_m)
        axes.plot(*path_in_plane.T, color="black", linewidth=1.2, label="camera")
        _limit_to(axes, path_in_plane, projected)
    axes.set_title(f"map: {len(points.landmark_id)} landmarks")
    finish_top_view(axes, plane, unit, marker_scale=5.0)
    save_figure(figure, path)


def plot_stage_times(stage_ms: Mapping[str, Mapping[str, float]], path: Path) -> None:
    """Milliseconds a frame of every stage: the bar is the median, the line reaches to p95."""
    figure = new_figure(height_in=1.2 + 0.32 * max(len(stage_ms), 1))
    axes = figure.add_subplot()
    names = list(stage_ms)
    medians = np.array([stage_ms[name]["p50"] for name in names])
    tails = np.array([stage_ms[name]["p95"] for name in names]) - medians
    if names:
        tails = np.vstack((np.zeros(len(names)), tails.clip(0)))
        axes.barh(names, medians, color="#1f77b4", xerr=tails, ecolor="#555555")
    axes.invert_yaxis()
    axes.set_xlabel("ms a frame (median, line to p95)")
    axes.set_title("time of every stage")
    save_figure(figure, path)


def plot_density(densities: Mapping[int, Density], path: Path) -> None:
    """Moving points around the camera over the frames, coloured by level."""
    figure = new_figure(height_in=3.6)
    axes = figure.add_subplot()
    frames = np.array(sorted(densities), dtype=np.int64)
    points = np.array([densities[frame].moving_points for frame in frames.tolist()])
    levels = np.array([densities[frame].level for frame in frames.tolist()])
    for level, colour in _LEVEL_COLOURS.items():
        chosen = levels == level
        axes.bar(frames[chosen], points[chosen], width=1.0, color=colour)
        axes.scatter([], [], marker="s", color=colour, label=f"{level.name.lower()} ({int(chosen.sum())} frames)")
        axes.scatter(
            frames[chosen],
            np.full(int(chosen.sum()), -0.02),
            s=6,
            marker="s",
            color=colour,
            clip_on=False,
            transform=axes.get_xaxis_transform(),
        )
    axes.set_ylim(bottom=0)
    axes.set_xlabel("frame")
    axes.set_ylabel("moving points around the camera")
    if densities:
        newest = densities[max(densities)]
        unit = "m" if newest.metric_scale else "map units"
        axes.set_ylabel(f"moving points within {newest.radius:g} {unit}")
    axes.set_title("density")
    axes.legend(loc="upper left", fontsize=8)
    save_figure(figure, path)


def _limit_to(axes: Axes, camera: npt.NDArray[np.float64], points: npt.NDArray[np.float64]) -> None:
    low, high = camera.min(axis=0), camera.max(axis=0)
    extent = float((high - low).max())
    if extent == 0.0:
        return
    if len(points):
        inner, outer = np.percentile(points, (_OUTLIERS, 100 - _OUTLIERS), axis=0)
        low, high = (
            np.minimum(low, np.maximum(inner, low - _FARTHEST * extent)),
            np.maximum(high, np.minimum(outer, high + _FARTHEST * extent)),
        )
    margin = _MARGIN * float((high - low).max())
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
