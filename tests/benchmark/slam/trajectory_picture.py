# SPDX-License-Identifier: Apache-2.0
"""A picture of trajectories from above, beside the truth."""

from collections.abc import Sequence
from math import ceil
from pathlib import Path

import numpy as np

from tests.benchmark.slam.engine_pass import PassReport


def draw_trajectories(reports: Sequence[PassReport], path: Path, columns: int = 3) -> None:
    """One panel a pass: the truth in grey, the aligned camera centres in red, along the truth's two longest axes."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    rows = ceil(len(reports) / columns)
    figure, panels = pyplot.subplots(rows, columns, figsize=(5 * columns, 5 * rows), squeeze=False)
    for panel, report in zip(panels.flat, reports, strict=False):
        truth = report.true_centers
        first, second = sorted(np.argsort(np.ptp(truth, axis=0))[1:])
        panel.plot(truth[:, first], truth[:, second], color="0.6", linewidth=3)
        panel.plot(report.centers[:, first], report.centers[:, second], "r.", markersize=1.5)
        panel.set_title(f"{report.name}\nATE {report.ate_m:.2f} m, coverage {report.coverage:.1%}", fontsize=9)
        panel.set_aspect("equal")
    figure.tight_layout()
    figure.savefig(path, dpi=70)
    pyplot.close(figure)
