# SPDX-License-Identifier: Apache-2.0
"""Figures 5.15 (bars), 5.16 and 5.18 (paths from above) of the thesis; 5.19 and 5.20 are `kinemap bench`'s own."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from services.evaluation.bench.paths import RunPath
from services.evaluation.pictures.figure import new_figure, save_figure
from services.evaluation.thesis.odometry import StageErrors
from services.evaluation.thesis.published import PUBLISHED_ODOMETRY
from services.evaluation.trajectory.estimates import EvaluatedTrajectory
from services.evaluation.trajectory.plots import COLOURS, plot_paths

_GREYS = ("#d0d0d0", "#a8a8a8", "#808080", "#585858")
_WIDTH = 0.85


def plot_bars(rows: Sequence[StageErrors], path: Path, *, whole_sequences: bool) -> None:
    """The average error of every system a sequence; the whiskers reach from our best trial to our worst."""
    sequences = list(dict.fromkeys(row.sequence for row in rows))
    stages = list(dict.fromkeys(row.stage for row in rows))
    published = [
        (column.name, grey, [column.ate_m.get(sequence) for sequence in sequences])
        for column, grey in zip(PUBLISHED_ODOMETRY, _GREYS, strict=True)
        if whole_sequences and any(sequence in column.ate_m for sequence in sequences)
    ]
    ours = {(row.sequence, row.stage): row for row in rows}
    bars = len(published) + len(stages)
    figure = new_figure(height_in=4.8, width_in=max(6.0, 2.0 + 0.45 * bars * len(sequences)))
    axes = figure.add_subplot()
    places = np.arange(len(sequences), dtype=np.float64)
    width = _WIDTH / bars
    for number, (name, grey, values) in enumerate(published):
        heights = [np.nan if value is None else value for value in values]
        axes.bar(places + width * (number - (bars - 1) / 2), heights, 0.95 * width, color=grey, label=name)
    for number, stage in enumerate(stages, start=len(published)):
        known = [row.known_m if (row := ours.get((sequence, stage))) else [] for sequence in sequences]
        means = np.array([np.mean(errors) if errors else np.nan for errors in known])
        low = means - [min(errors, default=np.nan) for errors in known]
        high = np.array([max(errors, default=np.nan) for errors in known]) - means
        axes.bar(
            places + width * (number - (bars - 1) / 2),
            means,
            0.95 * width,
            # the mean of equal trials may lie an ulp outside of them
            yerr=np.maximum(np.stack((low, high)), 0.0),
            capsize=3,
            color=COLOURS[(number - len(published)) % len(COLOURS)],
            label=f"kinemap, {stage}",
        )
    axes.set_xticks(places, [f"KITTI {sequence}" for sequence in sequences])
    axes.set_ylabel("mean ATE RMSE, Sim(3) [m]")
    axes.grid(visible=True, axis="y", linewidth=0.3)
    axes.set_axisbelow(True)
    figure.legend(loc="outside lower center", ncols=4, fontsize=8)
    save_figure(figure, path)


def plot_top_view(rows: Sequence[StageErrors], paths: Mapping[str, RunPath], sequence: str, path: Path) -> bool:
    """The path of each stage's middle trial over the truth. False, and no picture, where no trial has a path."""
    shown = []
    truth = None
    for row in rows:
        run = row.middle_run
        if row.sequence == sequence and run is not None and run.folder in paths:
            found = paths[run.folder]
            truth = truth or found.truth
            shown.append(EvaluatedTrajectory(row.stage, found.estimate, found.error))
    if truth is None:
        return False
    plot_paths(shown, truth, path)
    return True
