# SPDX-License-Identifier: Apache-2.0
"""The density of a run and the true one over time."""

from pathlib import Path

import numpy as np
from matplotlib.ticker import MaxNLocator

from schemas.records import DensityLevel
from services.evaluation.density.error import density_error
from services.evaluation.density.session import SessionDensities
from services.evaluation.pictures.figure import new_figure, save_figure

_LOW, _HIGH, _UNKNOWN = "#2e8b57", "#d62728", "#bbbbbb"


def plot_density_error(densities: SessionDensities, path: Path) -> None:
    """Above, the moving objects counted and the true ones; below, the level that was said and the true one."""
    frames = densities.frames
    seconds = np.array([frame.timestamp_ns - frames[0].timestamp_ns for frame in frames]) / 1e9
    unknown = np.array([frame.level is DensityLevel.UNKNOWN for frame in frames])
    estimated = np.array([frame.estimated_objects for frame in frames], dtype=np.float64)
    estimated[unknown] = np.nan
    figure = new_figure(height_in=4.5)
    counts, levels = figure.subplots(2, 1, sharex=True, height_ratios=(4, 1))
    true_objects = [frame.true_objects for frame in frames]
    counts.step(seconds, true_objects, where="mid", color="black", linewidth=2.5, label="truth")
    counts.step(seconds, estimated, where="mid", color="#1f77b4", linewidth=1.4, label="map")
    counts.set_ylim(0.0, max(1.0, counts.get_ylim()[1]))
    counts.set_ylabel(f"moving objects within {densities.radius * densities.metres_per_unit:.3g} m")
    counts.grid(visible=True, linewidth=0.3)
    counts.yaxis.set_major_locator(MaxNLocator(integer=True))
    error = density_error(frames)
    mean = "-" if error.mean_absolute_objects is None else f"{error.mean_absolute_objects:.2f}"
    counts.set_title(f"density: mean absolute error {mean} objects over {error.coverage:.1%} of {error.frames} frames")
    said = [_UNKNOWN if frame.level is DensityLevel.UNKNOWN else _level_colour(frame.level) for frame in frames]
    true = [_HIGH if frame.truly_high else _LOW for frame in frames]
    for place, colours in ((1.0, true), (0.0, said)):
        levels.scatter(seconds, np.full(len(frames), place), c=colours, marker="s", s=14, linewidths=0)
    for colour, name in ((_LOW, "low"), (_HIGH, "high"), (_UNKNOWN, "unknown")):
        counts.scatter([], [], c=colour, marker="s", s=14, label=name)
    counts.legend(loc="best", fontsize=8)
    levels.set_yticks((0.0, 1.0), ("map", "truth"))
    levels.set_ylim(-0.7, 1.7)
    levels.set_xlabel("time [s]")
    save_figure(figure, path)


def _level_colour(level: DensityLevel) -> str:
    return _HIGH if level is DensityLevel.HIGH else _LOW
