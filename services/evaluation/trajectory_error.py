# SPDX-License-Identifier: Apache-2.0
"""How far an estimate is from the true trajectory. Coverage stands beside every error: a lost frame has none."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from services.evaluation.alignment import MINIMUM_POSES, Alignment, Similarity, align
from services.evaluation.association import DEFAULT_MATCH_NS, Matches, match_by_time
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError


@dataclass(frozen=True)
class ErrorStatistics:
    """Of one error over all poses, in the error's unit."""

    rmse: float
    mean: float
    median: float
    max: float

    @classmethod
    def of(cls, errors: npt.NDArray[np.float64]) -> "ErrorStatistics":
        """Summarise (N,) errors, N > 0."""
        return cls(
            rmse=float(np.sqrt(np.mean(np.square(errors)))),
            mean=float(errors.mean()),
            median=float(np.median(errors)),
            max=float(errors.max()),
        )


@dataclass(frozen=True)
class TrajectoryError:
    """Absolute and relative error of `matches` poses out of `frames` of the input.

    `absolute_m` is the distance between aligned and true positions (thesis equation 4.1); the relative errors are of
    the motion over `delta_frames` frames (Sturm et al., "A benchmark for the evaluation of RGB-D SLAM systems", IROS
    2012), None where no two tracked frames are that far apart.
    """

    alignment: Alignment
    truth_from_estimate: Similarity
    frames: int
    matches: Matches
    errors_m: npt.NDArray[np.float64]
    absolute_m: ErrorStatistics
    delta_frames: int
    relative_m: ErrorStatistics | None
    relative_deg: ErrorStatistics | None

    @property
    def coverage(self) -> float:
        """The share of the input's frames that the error speaks of, 0..1."""
        return len(self.errors_m) / self.frames


def trajectory_error(
    estimate: Trajectory,
    truth: Trajectory,
    alignment: Alignment = Alignment.SIM3,
    *,
    frames: int | None = None,
    delta_frames: int = 1,
    max_difference_ns: int = DEFAULT_MATCH_NS,
) -> TrajectoryError:
    """Compare an estimate with the truth at the times they share.

    `frames` is the number of frames in the input, by default the true poses. Raises InputError where the times do not
    overlap, fewer than 3 poses match, or the estimate never leaves its place.
    """
    for trajectory in (estimate, truth):
        if len(trajectory) < MINIMUM_POSES:
            raise InputError(f"{trajectory.name}: {len(trajectory)} poses, expected at least {MINIMUM_POSES}")
    if delta_frames < 1:
        raise InputError(f"relative error over {delta_frames} frames, expected at least 1")
    matches = match_by_time(estimate, truth, max_difference_ns)
    if len(matches.estimate_index) < MINIMUM_POSES:
        raise InputError(
            f"{len(matches.estimate_index)} poses of {estimate.name} ({_span(estimate)}) are within"
            f" {max_difference_ns / 1e6:g} ms of {truth.name} ({_span(truth)}), expected at least {MINIMUM_POSES}"
        )
    estimated = estimate.world_from_camera[matches.estimate_index]
    true = truth.world_from_camera[matches.truth_index]
    truth_from_estimate = align(estimated[:, :3, 3], true[:, :3, 3], alignment)
    aligned = truth_from_estimate.poses(estimated)
    errors_m = np.linalg.norm(aligned[:, :3, 3] - true[:, :3, 3], axis=1)
    relative_m, relative_deg = _relative_errors(aligned, true, matches.truth_index, delta_frames)
    return TrajectoryError(
        alignment=alignment,
        truth_from_estimate=truth_from_estimate,
        frames=max(len(truth), len(errors_m)) if frames is None else frames,
        matches=matches,
        errors_m=errors_m,
        absolute_m=ErrorStatistics.of(errors_m),
        delta_frames=delta_frames,
        relative_m=ErrorStatistics.of(relative_m) if len(relative_m) else None,
        relative_deg=ErrorStatistics.of(relative_deg) if len(relative_deg) else None,
    )


def _relative_errors(
    aligned: npt.NDArray[np.float64],
    true: npt.NDArray[np.float64],
    truth_index: npt.NDArray[np.intp],
    delta_frames: int,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    # A pair across frames that were not tracked spans more time than the others: it is left out.
    later = np.searchsorted(truth_index, truth_index + delta_frames)
    inside = later < len(truth_index)
    earlier = np.flatnonzero(inside)[truth_index[later[inside]] == truth_index[inside] + delta_frames]
    later = later[earlier]
    true_motion = np.linalg.inv(true[earlier]) @ true[later]
    estimated_motion = np.linalg.inv(aligned[earlier]) @ aligned[later]
    difference = np.linalg.inv(true_motion) @ estimated_motion
    angle = Rotation.from_matrix(difference[:, :3, :3]).magnitude() if len(difference) else np.empty(0)
    return np.linalg.norm(difference[:, :3, 3], axis=1), np.degrees(angle)


def _span(trajectory: Trajectory) -> str:
    first, last = trajectory.timestamp_ns[0] / 1e9, trajectory.timestamp_ns[-1] / 1e9
    return f"{first:.3f} to {last:.3f} s"
