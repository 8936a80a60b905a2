# SPDX-License-Identifier: Apache-2.0
"""What the pictures share: drawn with Agg, so that no display is needed, and the same bytes for the same input."""

import warnings
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from services.evaluation.trajectory.ground_plane import GroundPlane
from services.runtime.errors import ResourceError

WIDTH_IN = 9.0

_LARGEST_SIDE_IN = 60.0
_LONGEST_NAME = 40


def new_figure(height_in: float = 7.0, width_in: float = WIDTH_IN) -> Figure:
    """An empty figure, each side at most 60 inches: an image of one column would ask for gigabytes."""
    sides_in = min(width_in, _LARGEST_SIDE_IN), min(height_in, _LARGEST_SIDE_IN)
    figure = Figure(figsize=sides_in, dpi=130, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def shown_name(name: str) -> str:
    """A name of the user's as a legend can show it: text, not too long, and not taken for a hidden one (empty, _)."""
    name = name.encode("utf-8", "replace").decode("utf-8") or "(no name)"
    kept = name if len(name) <= _LONGEST_NAME else f"{name[: _LONGEST_NAME // 2]}...{name[-_LONGEST_NAME // 2 :]}"
    return f" {kept}" if kept.startswith("_") else kept


def finish_top_view(axes: Axes, plane: GroundPlane, unit: str, marker_scale: float = 1.0) -> None:
    """Equal scales, the names of the plane's axes, a grid and a legend."""
    axes.set_aspect("equal", adjustable="datalim" if axes.get_autoscale_on() else "box")
    axes.set_xlabel(f"{plane.names[0]} [{unit}]")
    axes.set_ylabel(f"{plane.names[1]} [{unit}]")
    axes.grid(visible=True, linewidth=0.3)
    axes.legend(loc="best", fontsize=8, markerscale=marker_scale)


def save_figure(figure: Figure, path: Path) -> None:
    """Write a PNG that says nothing of when and by which version it was made.

    Raises ResourceError where it cannot be written.
    """
    _take_literally(figure)
    try:
        with mpl.rc_context({"svg.hashsalt": "kinemap"}), warnings.catch_warnings():
            # A letter that the font lacks becomes a box in the picture: that is all there is to say of it.
            warnings.filterwarnings("ignore", "Glyph .* missing from font", UserWarning)
            figure.savefig(path, metadata={"Software": None})
    except OSError as error:
        raise ResourceError(f"{path}: cannot be written ({error.strerror or error})") from error


def _take_literally(figure: Figure) -> None:
    """Names of files hold what matplotlib takes for a formula ($); its own powers of ten are formulas."""
    axes = [axis for one in figure.axes for axis in (one.xaxis, one.yaxis)]
    powers = {text for axis in axes if axis.get_scale() == "log" for text in axis.findobj(Text)}
    for text in figure.findobj(Text):
        if isinstance(text, Text) and text not in powers:
            text.set_parse_math(False)
