# SPDX-License-Identifier: Apache-2.0
"""How well a trajectory keeps its shape over short sections, whatever loops did to the whole of it."""

import numpy as np

from services.evaluation.trajectory.alignment import Alignment, align
from tests.benchmark.slam.engine_pass import PassReport

_FEWEST_POSES = 10


def section_error_m(report: PassReport, length_m: float) -> float:
    """Root mean square error over all sections of this length along the true way, each aligned for itself by Sim(3).

    Sections begin every half length. NaN where the way is shorter than one and a half of them.
    """
    truth, centers = report.true_centers[report.indices], report.centers
    way_m = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(truth, axis=0), axis=1))]
    starts = np.arange(0.0, way_m[-1] - length_m, length_m / 2)
    squares = []
    for first, end in np.searchsorted(way_m, np.stack([starts, starts + length_m], axis=1)):
        if end - first >= _FEWEST_POSES:
            part = slice(first, end)
            moved = align(centers[part], truth[part], Alignment.SIM3).points(centers[part])
            squares.append(float(((moved - truth[part]) ** 2).sum(axis=1).mean()))
    return float(np.sqrt(np.mean(squares))) if squares else float("nan")
