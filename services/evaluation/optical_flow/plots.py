# SPDX-License-Identifier: Apache-2.0
"""Pictures of flow beside the truth and its error, and how the errors of all pixels are spread."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.evaluation.optical_flow.error import (
    BINS_PER_PX,
    OUTLIER_PX,
    OUTLIER_SHARE,
    FlowError,
    endpoint_error,
)
from services.evaluation.optical_flow.inputs import FlowPair, read_flow
from services.evaluation.optical_flow.score import FlowScore
from services.evaluation.pictures.figure import new_figure, save_figure, shown_name
from services.evaluation.pictures.flow_colours import flow_colours
from services.formats.kitti_flow import FlowImage

_LONGEST_PERCENTILE = 90.0
_SHORTEST_SHOWN_PX = 0.05
_LONGEST_SHOWN_PX = 100.0

# KITTI's devkit: an error in multiples of the outlier's threshold, from blue (right) to red (wrong), doubling.
_ERROR_EDGES = np.array([0.0, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8, 16])
_ERROR_RGB = np.array([
    (49, 54, 149), (69, 117, 180), (116, 173, 209), (171, 217, 233), (224, 243, 248),
    (254, 224, 144), (253, 174, 97), (244, 109, 67), (215, 48, 39), (165, 0, 38),
], dtype=np.uint8)  # fmt: skip


def error_colours(error_px: npt.NDArray[np.float32], truth: FlowImage) -> npt.NDArray[np.uint8]:
    """KITTI's error colours, (H, W, 3) red-green-blue: blue is right, red an outlier of Fl, unknown black."""
    length = np.linalg.norm(truth.flow, axis=2)
    multiple = np.minimum(error_px / OUTLIER_PX, error_px / np.maximum(OUTLIER_SHARE * length, 1e-9))
    place = np.searchsorted(_ERROR_EDGES, np.nan_to_num(multiple), side="right") - 1
    colour: npt.NDArray[np.uint8] = _ERROR_RGB[place.clip(0, len(_ERROR_RGB) - 1)]
    colour[np.isnan(error_px)] = 0
    return colour


def plot_flow_pair(pair: FlowPair, path: Path) -> None:
    """The truth, what was found and its error, one above the other, both flows in the same colours."""
    truth, found = read_flow(pair.truth), read_flow(pair.found)
    error = endpoint_error(truth, found)
    alone = FlowError()
    alone.add(error, truth, truth.valid)
    lengths = np.linalg.norm(truth.flow, axis=2)[truth.valid]
    longest_px = float(np.percentile(lengths, _LONGEST_PERCENTILE)) if lengths.size else 1.0
    height, width = truth.valid.shape
    figure = new_figure(height_in=3 * (9.0 * height / width + 0.3) + 0.2)
    name = shown_name(pair.name)
    epe, outliers = (0.0 if value is None else value for value in (alone.epe_px, alone.outliers))
    rows = (
        (flow_colours(truth.flow, longest_px, truth.valid), f"{name}: truth (full colour: {longest_px:.1f} px)"),
        (flow_colours(found.flow, longest_px, found.valid), "found"),
        (
            error_colours(error, truth),
            f"error: {epe:.2f} px in the mean, Fl {outliers:.1%} (blue: right, red: outlier)",
        ),
    )
    for axes, (picture, title) in zip(figure.subplots(3, 1), rows, strict=True):
        axes.imshow(picture, interpolation="nearest")
        axes.set_title(title, fontsize=9)
        axes.set_axis_off()
    save_figure(figure, path)


def plot_flow_errors(score: FlowScore, path: Path) -> None:
    """Share of the pixels whose endpoint error is below each length."""
    figure = new_figure(height_in=4.0)
    axes = figure.add_subplot()
    for error, name, colour in ((score.all, "all pixels", "#1f77b4"), (score.visible, "not occluded", "#2e8b57")):
        if not error.true_pixels:
            continue
        below = np.cumsum(error.histogram[:-1]) / error.true_pixels
        edges = np.arange(1, below.size + 1) / BINS_PER_PX
        shown = (edges >= _SHORTEST_SHOWN_PX) & (edges <= _LONGEST_SHOWN_PX)
        places = np.unique(np.geomspace(1, int(shown.sum()), 400).astype(np.int64) - 1)
        axes.plot(edges[shown][places], below[shown][places], label=name, color=colour)
    axes.axvline(OUTLIER_PX, color="#999999", linewidth=0.8, linestyle="--", label=f"{OUTLIER_PX:g} px")
    axes.set_xscale("log")
    axes.set_ylim(0.0, 1.0)
    axes.set_xlabel("endpoint error [px]")
    axes.set_ylabel("share of pixels below")
    axes.set_title(f"endpoint error of {len(score.by_image)} images")
    axes.grid(visible=True, linewidth=0.3)
    axes.legend(loc="best", fontsize=8)
    save_figure(figure, path)
