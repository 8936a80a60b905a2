# SPDX-License-Identifier: Apache-2.0
"""What the pictures share: drawn with Agg, so that no display is needed, and the same bytes for the same input."""

from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from services.evaluation.trajectory.ground_plane import GroundPlane

WIDTH_IN = 9.0


def new_figure(height_in: float = 7.0, width_in: float = WIDTH_IN) -> Figure:
    """An empty figure."""
    figure = Figure(figsize=(width_in, height_in), dpi=130, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def finish_top_view(axes: Axes, plane: GroundPlane, unit: str, marker_scale: float = 1.0) -> None:
    """Equal scales, the names of the plane's axes, a grid and a legend."""
    axes.set_aspect("equal", adjustable="datalim" if axes.get_autoscale_on() else "box")
    axes.set_xlabel(f"{plane.names[0]} [{unit}]")
    axes.set_ylabel(f"{plane.names[1]} [{unit}]")
    axes.grid(visible=True, linewidth=0.3)
    axes.legend(loc="best", fontsize=8, markerscale=marker_scale)


def save_figure(figure: Figure, path: Path) -> None:
    """Write a PNG that says nothing of when and by which version it was made."""
    with mpl.rc_context({"svg.hashsalt": "kinemap"}):
        figure.savefig(path, metadata={"Software": None})
