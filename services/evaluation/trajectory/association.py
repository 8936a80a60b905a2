# SPDX-License-Identifier: Apache-2.0
"""Which poses of two trajectories belong to the same moment."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from services.formats.trajectory import Trajectory

DEFAULT_MATCH_NS = 10_000_000


class Matches(NamedTuple):
    """Rows of two trajectories that belong to the same moment, both (M,) and increasing."""

    estimate_index: npt.NDArray[np.intp]
    truth_index: npt.NDArray[np.intp]


def match_by_time(estimate: Trajectory, truth: Trajectory, max_difference_ns: int = DEFAULT_MATCH_NS) -> Matches:
    """Pair each estimated pose with the truth nearest in time, each truth used once, by the estimate nearest to it."""
    if len(estimate) == 0 or len(truth) == 0:
        empty = np.empty(0, dtype=np.intp)
        return Matches(empty, empty)
    right = np.searchsorted(truth.timestamp_ns, estimate.timestamp_ns).clip(0, len(truth) - 1)
    left = (right - 1).clip(0)
    right_gap = np.abs(truth.timestamp_ns[right] - estimate.timestamp_ns)
    left_gap = np.abs(truth.timestamp_ns[left] - estimate.timestamp_ns)
    nearest = np.where(left_gap <= right_gap, left, right)
    gap = np.minimum(left_gap, right_gap)
    by_truth_then_gap = np.lexsort((gap, nearest))
    _, first = np.unique(nearest[by_truth_then_gap], return_index=True)
    chosen = np.sort(by_truth_then_gap[first])
    chosen = chosen[gap[chosen] <= max_difference_ns]
    return Matches(chosen, nearest[chosen])
