# SPDX-License-Identifier: Apache-2.0
"""The frames that a relative error goes over: those of the input, tracked or not."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from services.evaluation.trajectory.association import Matches
from services.formats.trajectory import Trajectory, period_ns


@dataclass(frozen=True)
class ReferenceFrames:
    """K frames in the order of time, with the true pose of each.

    `world_from_camera` (K, 4, 4) true; `row` (K,) of the matched poses, -1 where the frame was not tracked; `path_m`
    (K,) true metres from the first frame on.
    """

    world_from_camera: npt.NDArray[np.float64]
    row: npt.NDArray[np.intp]
    path_m: npt.NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.row)

    def tracked(self, pairs: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
        """Those of (P, 2) pairs of frames of which both were tracked."""
        chosen: npt.NDArray[np.intp] = pairs[(self.row[pairs] >= 0).all(axis=1)]
        return chosen


def reference_frames(truth: Trajectory, matches: Matches, rate_hz: float | None = None) -> ReferenceFrames:
    """Every true pose is a frame; with `rate_hz`, where the truth is denser than the input's frames, the matched true
    poses are frames and, where none matched for longer than a frame, the true poses nearest to the rate's times.

    Raises InputError for a rate outside 0.001 to 10000 Hz.
    """
    if rate_hz is None:
        rows = np.arange(len(truth), dtype=np.intp)
    else:
        rows = _rows_at_rate(truth.timestamp_ns, matches.truth_index, period_ns(rate_hz))
    matched = np.full(len(truth), -1, dtype=np.intp)
    matched[matches.truth_index] = np.arange(len(matches.truth_index))
    steps_m = np.linalg.norm(np.diff(truth.positions_m[rows], axis=0), axis=1)
    return ReferenceFrames(truth.world_from_camera[rows], matched[rows], np.concatenate(([0.0], np.cumsum(steps_m))))


def _rows_at_rate(
    timestamp_ns: npt.NDArray[np.int64], matched: npt.NDArray[np.intp], period_ns: float
) -> npt.NDArray[np.intp]:
    # An end without a match is a gap like any other: one period beyond the truth stands for the frame that bounds it.
    times = timestamp_ns[matched].astype(np.float64)
    bounds = np.concatenate(([timestamp_ns[0] - period_ns], times, [timestamp_ns[-1] + period_ns]))
    rows = [matched]
    for begin, end in pairwise(bounds.tolist()):
        missing = round((end - begin) / period_ns) - 1
        if missing > 0:
            wanted = np.linspace(begin, end, missing + 2)[1:-1]
            right = np.searchsorted(timestamp_ns, wanted).clip(1, len(timestamp_ns) - 1)
            nearer_left = wanted - timestamp_ns[right - 1] <= timestamp_ns[right] - wanted
            nearest = np.where(nearer_left, right - 1, right)
            rows.append(nearest[np.abs(timestamp_ns[nearest] - wanted) <= period_ns / 2])
    return np.unique(np.concatenate(rows))
