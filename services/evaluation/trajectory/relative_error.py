# SPDX-License-Identifier: Apache-2.0
"""The error of motions instead of places: it forgives drift that happened before."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from services.evaluation.trajectory.reference_frames import ReferenceFrames
from services.evaluation.trajectory.statistics import ErrorStatistics
from services.runtime.errors import InputError

_MOST_FRAMES = 10**9
_PATH_TOLERANCE = 0.1
"""a pair is as far apart as asked for when it is so within this share"""


@dataclass(frozen=True)
class RelativeError:
    """Error of the motion over `delta` frames or metres of the true path (Sturm et al., "A benchmark for the
    evaluation of RGB-D SLAM systems", IROS 2012), over all pairs of frames that far apart.

    `possible` pairs are in the input, of `pairs` both frames were tracked; the errors are None where that is 0.
    """

    delta: float
    unit: Literal["frames", "m"]
    possible: int
    pairs: int
    translation_m: ErrorStatistics | None
    rotation_deg: ErrorStatistics | None

    @property
    def coverage(self) -> float:
        """The share of the input's pairs that the error speaks of, 0..1; 0 where there are none."""
        return self.pairs / self.possible if self.possible else 0.0


def error_by_frames(frames: ReferenceFrames, aligned: npt.NDArray[np.float64], delta: int) -> RelativeError:
    """`aligned` (M, 4, 4) are the estimated poses by `ReferenceFrames.row`.

    Raises InputError for another `delta` than 1 to 10^9.
    """
    if not 1 <= delta <= _MOST_FRAMES:
        raise InputError(f"relative error over {delta} frames, expected 1 to {_MOST_FRAMES}")
    first = np.arange(max(len(frames) - delta, 0), dtype=np.intp)
    return _over(frames, aligned, np.stack((first, first + delta), axis=1), delta, "frames")


def error_by_path(frames: ReferenceFrames, aligned: npt.NDArray[np.float64], delta_m: float) -> RelativeError:
    """From every frame to the one whose way along the true path is nearest to `delta_m`, where it is so within a tenth.

    Raises InputError for `delta_m` that is not above 0.
    """
    if not (np.isfinite(delta_m) and delta_m > 0.0):
        raise InputError(f"relative error over {delta_m:g} m, expected a number above 0")
    return _over(frames, aligned, path_pairs(frames.path_m, delta_m), delta_m, "m")


def path_pairs(path_m: npt.NDArray[np.float64], delta_m: float) -> npt.NDArray[np.intp]:
    """(P, 2) pairs of rows of a path (K,) that are `delta_m` apart within a tenth, at most one from each row."""
    first = np.arange(len(path_m) - 1, dtype=np.intp)
    beyond = np.searchsorted(path_m, path_m[first] + delta_m).clip(first + 1, len(path_m) - 1)
    before = (beyond - 1).clip(first + 1)
    gap_beyond = np.abs(path_m[beyond] - path_m[first] - delta_m)
    gap_before = np.abs(path_m[before] - path_m[first] - delta_m)
    second = np.where(gap_before <= gap_beyond, before, beyond)
    near = np.minimum(gap_before, gap_beyond) <= _PATH_TOLERANCE * delta_m
    # A camera that stands gives one length of path to many rows: the first of them is meant.
    second = np.searchsorted(path_m, path_m[second]).clip(first + 1)
    return np.stack((first[near], second[near]), axis=1)


def _motion_errors(
    frames: ReferenceFrames, aligned: npt.NDArray[np.float64], pairs: npt.NDArray[np.intp]
) -> npt.NDArray[np.float64]:
    true_motion = _inverse(frames.world_from_camera[pairs[:, 0]]) @ frames.world_from_camera[pairs[:, 1]]
    rows = frames.row[pairs]
    estimated_motion = _inverse(aligned[rows[:, 0]]) @ aligned[rows[:, 1]]
    difference: npt.NDArray[np.float64] = _inverse(true_motion) @ estimated_motion
    return difference


def _inverse(poses: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    # As for a rotation, though one read from six digits is none to the last of them: so does the reference (evo).
    inverse = np.tile(np.eye(4), (len(poses), 1, 1))
    inverse[:, :3, :3] = poses[:, :3, :3].transpose(0, 2, 1)
    inverse[:, :3, 3] = -np.einsum("nji,nj->ni", poses[:, :3, :3], poses[:, :3, 3])
    return inverse


def _over(
    frames: ReferenceFrames,
    aligned: npt.NDArray[np.float64],
    pairs: npt.NDArray[np.intp],
    delta: float,
    unit: Literal["frames", "m"],
) -> RelativeError:
    tracked = frames.tracked(pairs)
    if len(tracked) == 0:
        return RelativeError(delta, unit, len(pairs), 0, None, None)
    difference = _motion_errors(frames, aligned, tracked)
    return RelativeError(
        delta,
        unit,
        possible=len(pairs),
        pairs=len(tracked),
        translation_m=ErrorStatistics.of(np.linalg.norm(difference[:, :3, 3], axis=1)),
        rotation_deg=ErrorStatistics.of(np.degrees(Rotation.from_matrix(difference[:, :3, :3]).magnitude())),
    )
