# SPDX-License-Identifier: Apache-2.0
"""How far an estimate is from the true trajectory. Coverage stands beside every error: a lost frame has none."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.evaluation.trajectory.alignment import MINIMUM_POSES, Alignment, Similarity, align
from services.evaluation.trajectory.association import DEFAULT_MATCH_NS, Matches, match_by_time
from services.evaluation.trajectory.kitti_segments import SegmentErrors, segment_errors
from services.evaluation.trajectory.reference_frames import reference_frames
from services.evaluation.trajectory.relative_error import RelativeError, error_by_frames, error_by_path
from services.evaluation.trajectory.statistics import ErrorStatistics
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError

DEFAULT_PATH_M = 10.0


@dataclass(frozen=True)
class TrajectoryError:
    """Absolute and relative error of `matches` poses out of `frames` of the input.

    `absolute_m` is the distance between aligned and true positions (thesis equation 4.1) and `errors_m` (M,) that of
    every match; `truth_from_estimate` is the alignment that was found. The relative errors and KITTI's are of the
    aligned poses, so that a Sim(3) gives a trajectory of unknown scale its metres.
    """

    alignment: Alignment
    truth_from_estimate: Similarity
    frames: int
    matches: Matches
    errors_m: npt.NDArray[np.float64]
    absolute_m: ErrorStatistics
    by_frames: RelativeError
    by_path: RelativeError
    segments: SegmentErrors

    @property
    def coverage(self) -> float:
        """The share of the input's frames that the absolute error speaks of, 0..1."""
        return len(self.errors_m) / self.frames


def trajectory_error(
    estimate: Trajectory,
    truth: Trajectory,
    alignment: Alignment = Alignment.SIM3,
    *,
    frames: int | None = None,
    rate_hz: float | None = None,
    delta_frames: int = 1,
    delta_m: float = DEFAULT_PATH_M,
    max_difference_ns: int = DEFAULT_MATCH_NS,
) -> TrajectoryError:
    """Compare an estimate with the truth at the times they share.

    The input's frames are the true poses, or those at `rate_hz` where the truth is denser (`reference_frames`);
    `frames` overrides their number for the coverage. Raises InputError where the times do not overlap, fewer than 3
    poses match, the estimate never leaves its place, or an option is out of its range.
    """
    for trajectory in (estimate, truth):
        if len(trajectory) < MINIMUM_POSES:
            raise InputError(f"{trajectory.name}: {len(trajectory)} poses, expected at least {MINIMUM_POSES}")
    matches = match_by_time(estimate, truth, max_difference_ns)
    if len(matches.estimate_index) < MINIMUM_POSES:
        raise InputError(
            f"{len(matches.estimate_index)} poses of {estimate.name} ({_span(estimate)}) are within"
            f" {max_difference_ns / 1e6:g} ms of {truth.name} ({_span(truth)}), expected at least {MINIMUM_POSES}"
        )
    estimated = estimate.world_from_camera[matches.estimate_index]
    true_positions = truth.positions_m[matches.truth_index]
    try:
        truth_from_estimate = align(estimated[:, :3, 3], true_positions, alignment)
    except InputError as error:
        raise InputError(f"{estimate.name}: {error}") from None
    aligned = truth_from_estimate.poses(estimated)
    errors_m = np.linalg.norm(aligned[:, :3, 3] - true_positions, axis=1)
    reference = reference_frames(truth, matches, rate_hz)
    return TrajectoryError(
        alignment=alignment,
        truth_from_estimate=truth_from_estimate,
        frames=max(len(reference), len(errors_m)) if frames is None else _at_least(frames, len(errors_m)),
        matches=matches,
        errors_m=errors_m,
        absolute_m=ErrorStatistics.of(errors_m),
        by_frames=error_by_frames(reference, aligned, delta_frames),
        by_path=error_by_path(reference, aligned, delta_m),
        segments=segment_errors(reference, aligned),
    )


def _at_least(frames: int, poses: int) -> int:
    if frames < poses:
        raise InputError(f"{frames} frames in the input, expected at least the {poses} poses that have a true one")
    return frames


def _span(trajectory: Trajectory) -> str:
    first, last = trajectory.timestamp_ns[0] / 1e9, trajectory.timestamp_ns[-1] / 1e9
    return f"{first:.3f} to {last:.3f} s"
