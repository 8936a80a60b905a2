# SPDX-License-Identifier: Apache-2.0
"""The errors of the KITTI odometry benchmark: over segments of 100 to 800 m, per metre driven.

Geiger, Lenz, Urtasun, "Are we ready for autonomous driving? The KITTI vision benchmark suite", CVPR 2012, and the
formula of its development kit (evaluate_odometry): from every tenth frame to the first one more than the length away.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.evaluation.trajectory.reference_frames import ReferenceFrames

SEGMENT_LENGTHS_M = (100, 200, 300, 400, 500, 600, 700, 800)
FIRST_FRAME_STEP = 10


@dataclass(frozen=True)
class SegmentError:
    """Means over the segments of one length, or of all (`length_m` None).

    `possible` segments are in the input, of `segments` first and last frame were tracked; the errors are None where
    that is 0.
    """

    length_m: int | None
    possible: int
    segments: int
    translation_percent: float | None
    rotation_deg_per_m: float | None

    @property
    def coverage(self) -> float:
        """The share of the input's segments that the error speaks of, 0..1; 0 where there are none."""
        return self.segments / self.possible if self.possible else 0.0


@dataclass(frozen=True)
class SegmentErrors:
    """`overall` is the mean over all segments of all lengths, as the benchmark ranks by."""

    overall: SegmentError
    by_length: tuple[SegmentError, ...]


def segment_errors(frames: ReferenceFrames, aligned: npt.NDArray[np.float64]) -> SegmentErrors:
    """`aligned` (M, 4, 4) are the estimated poses by `ReferenceFrames.row`, in metres.

    The motion within a segment is compared, so that of the alignment only the scale counts. A segment whose first or
    last frame was not tracked has no error, where the development kit expects every frame.
    """
    by_length = []
    all_translation: list[npt.NDArray[np.float64]] = []
    all_rotation: list[npt.NDArray[np.float64]] = []
    for length_m in SEGMENT_LENGTHS_M:
        pairs = _segments(frames.path_m, length_m)
        tracked = frames.tracked(pairs)
        motion = _pose_errors(frames, aligned, tracked)
        translation = np.linalg.norm(motion[:, :3, 3], axis=1) / length_m
        cosine = 0.5 * (np.trace(motion[:, :3, :3], axis1=1, axis2=2) - 1.0)
        rotation = np.arccos(cosine.clip(-1.0, 1.0)) / length_m
        all_translation.append(translation)
        all_rotation.append(rotation)
        by_length.append(_mean(length_m, len(pairs), translation, rotation))
    possible = sum(error.possible for error in by_length)
    overall = _mean(None, possible, np.concatenate(all_translation), np.concatenate(all_rotation))
    return SegmentErrors(overall, tuple(by_length))


def _segments(path_m: npt.NDArray[np.float64], length_m: int) -> npt.NDArray[np.intp]:
    first = np.arange(0, len(path_m), FIRST_FRAME_STEP, dtype=np.intp)
    last = np.searchsorted(path_m, path_m[first] + length_m, side="right")
    inside = last < len(path_m)
    return np.stack((first[inside], last[inside]), axis=1)


def _pose_errors(
    frames: ReferenceFrames, aligned: npt.NDArray[np.float64], pairs: npt.NDArray[np.intp]
) -> npt.NDArray[np.float64]:
    # The kit's own order, and its inverse of a general matrix: poses of six digits are no rotations to the last.
    true_motion = np.linalg.inv(frames.world_from_camera[pairs[:, 0]]) @ frames.world_from_camera[pairs[:, 1]]
    rows = frames.row[pairs]
    estimated_motion = np.linalg.inv(aligned[rows[:, 0]]) @ aligned[rows[:, 1]]
    errors: npt.NDArray[np.float64] = np.linalg.inv(estimated_motion) @ true_motion
    return errors


def _mean(
    length_m: int | None, possible: int, translation: npt.NDArray[np.float64], rotation: npt.NDArray[np.float64]
) -> SegmentError:
    if len(translation) == 0:
        return SegmentError(length_m, possible, 0, None, None)
    percent, degrees = 100.0 * float(translation.mean()), float(np.degrees(rotation.mean()))
    return SegmentError(length_m, possible, len(translation), percent, degrees)
