# SPDX-License-Identifier: Apache-2.0
"""The curves of a training, as numbers that last and as a picture."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

Curves = Mapping[str, Sequence[Sequence[float]]]
"""By name, [step, value] each."""

_PANELS_A_ROW = 4
_SMOOTHED = 50
"""Points that the drawn line is the mean of."""


def draw_curves(curves: Curves, path: Path) -> None:
    """One panel a curve: the values faint, their running mean strong."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    shown = {name: np.asarray(points, float) for name, points in curves.items() if points}
    columns = max(1, min(_PANELS_A_ROW, len(shown)))
    rows = max(1, -(-len(shown) // columns))
    figure = Figure(figsize=(4.5 * columns, 3.6 * rows), layout="constrained")
    FigureCanvasAgg(figure)
    for number, (name, points) in enumerate(shown.items()):
        axes = figure.add_subplot(rows, columns, number + 1)
        few = len(points) < 4 * _SMOOTHED
        axes.plot(points[:, 0], points[:, 1], color="C0", alpha=1.0 if few else 0.2, linewidth=1.0)
        if not few:
            mean = np.convolve(points[:, 1], np.full(_SMOOTHED, 1 / _SMOOTHED), mode="valid")
            axes.plot(points[_SMOOTHED - 1 :, 0], mean, color="C0", linewidth=1.5)
        axes.set_title(name)
        axes.set_xlabel("step")
        axes.grid(visible=True, linewidth=0.3)
    figure.savefig(path, dpi=110)
