# SPDX-License-Identifier: Apache-2.0
"""A benchmark's pictures: errors of every variant (thesis, figure 5.20), seed by seed, and paths by axis (5.19)."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from services.evaluation.bench.paths import RunPath
from services.evaluation.bench.runs import BenchRun, RunStatus, tracked
from services.evaluation.bench.table import groups
from services.evaluation.pictures.figure import new_figure, save_figure

_COLOURS = ("#7f7f7f", "#1f77b4", "#2e8b57", "#d62728", "#9467bd", "#e0a800", "#17becf", "#8c564b")
_ACROSS = 3


def plot_errors(runs: Sequence[BenchRun], paths: Mapping[str, RunPath], path: Path, label: str = "") -> None:
    """A violin a variant, of every frame's error (Sim(3)) over all runs that were tracked; dots are the runs' RMSE."""
    figure, panels = _panels(runs, label, "error of every frame [m], dots: RMSE of a run")
    for source, axes in panels.items():
        variants = [variant for name, variant in groups(runs) if name == source]
        for place, variant in enumerate(variants):
            kept = [paths[run.folder] for run in tracked(runs, source, variant) if run.folder in paths]
            if not kept:
                continue
            colour = _COLOURS[place % len(_COLOURS)]
            errors_m = np.concatenate([run.error.errors_m for run in kept])
            if np.ptp(errors_m) > 0.0:
                parts = axes.violinplot(errors_m, [place], widths=0.8, showextrema=False, showmedians=True)
                for body in np.atleast_1d(np.asarray(parts["bodies"], dtype=object)):
                    body.set_facecolor(colour)
                parts["cmedians"].set_color(colour)
            rmse_m = [run.error.absolute_m.rmse for run in kept]
            beside = place + 0.04 * (np.arange(len(rmse_m)) - (len(rmse_m) - 1) / 2)
            axes.plot(beside, rmse_m, marker="o", markersize=4, linestyle="none", color="black")
        _name_variants(axes, runs, source, variants)
        axes.set_ylim(bottom=0.0)
    save_figure(figure, path)


def plot_trials(runs: Sequence[BenchRun], path: Path, label: str = "") -> None:
    """A line a seed (or repeat) over the variants; a cross at the upper edge is a run that was lost or failed."""
    figure, panels = _panels(runs, label, "ATE RMSE, Sim(3) [m]")
    for source, axes in panels.items():
        variants = [variant for name, variant in groups(runs) if name == source]
        trials = list(dict.fromkeys(run.trial for run in runs if run.input == source))
        for number, trial in enumerate(trials):
            colour = mpl.colormaps["tab10"](number % 10)
            found = {run.variant: run for run in runs if (run.input, run.trial) == (source, trial)}
            rmse_m = [_rmse_m(found.get(variant)) for variant in variants]
            axes.plot(range(len(variants)), rmse_m, marker="o", color=colour, label=trial, linewidth=1.2)
            for place, variant in enumerate(variants):
                if variant in found and _is_setback(found[variant]):
                    beside = place + 0.05 * (number - (len(trials) - 1) / 2)
                    axes.plot(beside, 0.97, "x", color=colour, transform=axes.get_xaxis_transform())
        _name_variants(axes, runs, source, variants)
        axes.set_ylim(0.0, 1.15 * axes.get_ylim()[1])
        axes.legend(fontsize=7)
    save_figure(figure, path)


def plot_axes(runs: Sequence[BenchRun], paths: Mapping[str, RunPath], source: str, path: Path, label: str = "") -> None:
    """x, y and z over time of one seed (or repeat): the truth, and every variant's path.

    It is the one whose errors are in the middle of those that most variants were tracked in.
    """
    figure = new_figure(height_in=7.5, width_in=10.0)
    rows: Sequence[Axes] = figure.subplots(3, 1, sharex=True)
    variants = [variant for name, variant in groups(runs) if name == source]
    trial, chosen = _middle_trial(runs, paths, source)
    for number, (variant, run) in enumerate(chosen.items()):
        begin_ns = run.truth.timestamp_ns[0]
        aligned_m = run.error.truth_from_estimate.points(run.estimate.positions_m)
        colour = _COLOURS[variants.index(variant) % len(_COLOURS)]
        shown = f"{variant} ({run.error.absolute_m.rmse:.3f} m)"
        for axis, axes in enumerate(rows):
            if number == 0:
                times_s = (run.truth.timestamp_ns - begin_ns) / 1e9
                axes.plot(times_s, run.truth.positions_m[:, axis], color="black", linewidth=2.5, label="ground truth")
            times_s = (run.estimate.timestamp_ns - begin_ns) / 1e9
            axes.plot(times_s, aligned_m[:, axis], color=colour, linewidth=1.2, label=shown)
    for name, axes in zip("xyz", rows, strict=True):
        axes.set_ylabel(f"{name} [m]")
        axes.grid(visible=True, linewidth=0.3)
    rows[-1].set_xlabel("time [s]")
    if chosen:
        rows[0].legend(fontsize=8)
    rows[0].set_title(" - ".join(part for part in (label, source, trial) if part))
    save_figure(figure, path)


def _middle_trial(
    runs: Sequence[BenchRun], paths: Mapping[str, RunPath], source: str
) -> tuple[str, dict[str, RunPath]]:
    # Seeds drive different ways: only paths of one seed have one truth.
    trials: dict[str, dict[str, RunPath]] = {}
    for run in runs:
        if run.input == source and run.folder in paths:
            trials.setdefault(run.trial, {})[run.variant] = paths[run.folder]
    most = max((len(found) for found in trials.values()), default=0)
    full = [(trial, found) for trial, found in trials.items() if len(found) == most]
    full.sort(key=lambda one: sum(run.error.absolute_m.rmse for run in one[1].values()))
    return full[(len(full) - 1) // 2] if full else ("", {})


def _panels(runs: Sequence[BenchRun], label: str, what: str) -> tuple[Figure, dict[str, Axes]]:
    inputs = list(dict.fromkeys(run.input for run in runs))
    across = min(len(inputs), _ACROSS)
    down = -(-len(inputs) // across)
    width_in = 1.6 + 1.1 * max(len({run.variant for run in runs}), 3)
    figure = new_figure(height_in=4.6 * down, width_in=width_in * across)
    figure.supylabel(what, fontsize=9)
    if label:
        figure.suptitle(label)
    grid = figure.subplots(down, across, squeeze=False).ravel()
    for unused in grid[len(inputs) :]:
        unused.set_axis_off()
    for source, axes in zip(inputs, grid, strict=False):
        axes.set_title(source)
        axes.grid(visible=True, axis="y", linewidth=0.3)
    return figure, dict(zip(inputs, grid, strict=False))


def _name_variants(axes: Axes, runs: Sequence[BenchRun], source: str, variants: Sequence[str]) -> None:
    names = []
    for variant in variants:
        group = [run for run in runs if (run.input, run.variant) == (source, variant)]
        gone = sum(_is_setback(run) for run in group)
        count = "1 run" if len(group) == 1 else f"{len(group)} runs"
        names.append(f"{variant}\n{count}" + (f", {gone} lost or failed" if gone else ""))
    axes.set_xticks(range(len(variants)), names, fontsize=8)
    axes.set_xlim(-0.6, len(variants) - 0.4)


def _is_setback(run: BenchRun) -> bool:
    return run.status is not RunStatus.TRACKED


def _rmse_m(run: BenchRun | None) -> float:
    if run is None or run.measures is None or run.measures.ate_sim3_m is None or _is_setback(run):
        return float("nan")
    return run.measures.ate_sim3_m
