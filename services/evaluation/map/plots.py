# SPDX-License-Identifier: Apache-2.0
"""Pictures of a map's error: where it is off the surface, and which labels are taken for which."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from schemas.records import MotionState
from services.evaluation.map.error import LABELS, MapError
from services.evaluation.map.table import SAID
from services.evaluation.pictures.figure import finish_top_view, new_figure, save_figure
from services.evaluation.trajectory.ground_plane import GroundPlane
from services.formats.point_cloud import LabelledPoints

_DRAWN_SURFACE_POINTS = 40_000
_OUTLIERS = 0.5
_WORST_SHOWN = 95.0


def plot_map_error(
    landmarks: LabelledPoints, surface: LabelledPoints, error: MapError, plane: GroundPlane, path: Path
) -> None:
    """Top view of the landmarks that were compared, in the colour of their distance, over the surface in grey."""
    standing = surface.chosen(surface.state != MotionState.MOVING)
    under = plane.project(standing.position[:: max(1, len(standing) // _DRAWN_SURFACE_POINTS)])
    compared = np.isfinite(error.landmark_distance_m)
    distance = error.landmark_distance_m[compared]
    x, y = plane.project(landmarks.position[compared]).T
    low, high = _limits(np.concatenate((under, np.stack((x, y), axis=1))))
    width_in, height_in = _size(high - low)
    figure = new_figure(height_in=height_in, width_in=width_in)
    axes = figure.add_subplot()
    axes.scatter(under[:, 0], under[:, 1], s=1, color="#cccccc", linewidths=0, label="surface", rasterized=True)
    farthest = max(float(np.percentile(distance, _WORST_SHOWN)), 1e-6)
    shown = axes.scatter(x, y, 4, distance, cmap="viridis_r", vmin=0.0, vmax=farthest, linewidths=0, label="landmarks")
    figure.colorbar(shown, ax=axes, extend="max", label="distance to the surface [m]", shrink=0.8)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    # Over the whole figure: the street may be narrow.
    figure.suptitle(
        f"map against surface: median {error.accuracy.median_m:.3f} m, mean {error.accuracy.mean_m:.3f} m\n"
        f"{error.accuracy.points} of {error.landmarks} landmarks",
        fontsize=10,
    )
    finish_top_view(axes, plane, "m", marker_scale=4.0)
    save_figure(figure, path)


def plot_label_confusion(error: MapError, path: Path) -> None:
    """What the landmarks near a surface are, by row, and what the map calls them, as shares of the row."""
    figure = new_figure(height_in=4.2, width_in=6.5)
    axes = figure.add_subplot()
    rows = error.confusion.sum(axis=1, keepdims=True)
    shares = np.divide(error.confusion, rows, out=np.zeros(error.confusion.shape), where=rows > 0)
    axes.imshow(shares, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for row, counts in enumerate(error.confusion.tolist()):
        for column, count in enumerate(counts):
            colour = "white" if shares[row, column] > 0.5 else "black"
            text = f"{count}\n{shares[row, column]:.1%}" if rows[row, 0] else "-"
            axes.text(column, row, text, ha="center", va="center", color=colour, fontsize=9)
    axes.set_xticks(range(len(SAID)), SAID)
    axes.set_yticks(range(len(LABELS)), SAID[: len(LABELS)])
    axes.set_xlabel("the map says")
    axes.set_ylabel("it is")
    accuracy = "undefined" if error.label_accuracy is None else f"{error.label_accuracy:.3f}"
    axes.set_title(f"labels of landmarks: accuracy {accuracy}")
    save_figure(figure, path)


def _limits(places: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    low, high = np.percentile(places, (_OUTLIERS, 100 - _OUTLIERS), axis=0)
    margin = max(0.05 * float((high - low).max()), 1e-3)
    return low - margin, high + margin


def _size(extent: npt.NDArray[np.float64]) -> tuple[float, float]:
    """Width and height in inches of a figure that such a view fills, the colour bar beside it."""
    scale = min(8.0 / float(extent[0]), 7.0 / float(extent[1]))
    return max(scale * float(extent[0]) + 1.8, 5.0), max(scale * float(extent[1]) + 1.2, 3.0)
