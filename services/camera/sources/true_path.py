# SPDX-License-Identifier: Apache-2.0
"""Where the camera really was when an image was taken, from a trajectory sampled at times of its own."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from schemas.codec.rigid import matrix_from_pose, pose_from_matrix
from services.formats.trajectory import Trajectory

Pose = npt.NDArray[np.float64]

NEAREST_NS = 20_000_000
"""a sample this near stands for the frame where there is nothing to interpolate between"""
LONGEST_GAP_NS = 200_000_000
"""between samples further apart nobody knows how the camera went"""


def poses_at(path: Trajectory, times_ns: Sequence[int]) -> list[Pose | None]:
    """(4, 4) world_from_camera at each time, metres; None where the path says nothing of it.

    Positions are interpolated linearly, rotations spherically (Shoemake, "Animating rotation with quaternion curves",
    SIGGRAPH 1985).
    """
    samples = path.timestamp_ns
    poses: list[Pose | None] = []
    for time_ns, after in zip(times_ns, np.searchsorted(samples, np.asarray(times_ns)).tolist(), strict=True):
        if after < len(samples) and samples[after] == time_ns:
            poses.append(path.world_from_camera[after])
        elif 0 < after < len(samples) and samples[after] - samples[after - 1] <= LONGEST_GAP_NS:
            share = float(time_ns - samples[after - 1]) / float(samples[after] - samples[after - 1])
            poses.append(_between(path.world_from_camera[after - 1], path.world_from_camera[after], share))
        else:
            around = [index for index in (after - 1, after) if 0 <= index < len(samples)]
            nearest = min(around, key=lambda index: abs(int(samples[index]) - time_ns))
            near = abs(int(samples[nearest]) - time_ns) <= NEAREST_NS
            poses.append(path.world_from_camera[nearest] if near else None)
    return poses


def note_of_missing(poses: Sequence[Pose | None]) -> list[str]:
    """What to tell of frames without truth; nothing where all have it."""
    missing = sum(pose is None for pose in poses)
    return (
        [f"{missing} of {len(poses)} frames have no true pose: the truth does not reach over them"] if missing else []
    )


def _between(earlier: Pose, later: Pose, share: float) -> Pose:
    one, other = pose_from_matrix(earlier), pose_from_matrix(later)
    cosine = float(one[3:] @ other[3:])
    if cosine < 0:
        other[3:], cosine = -other[3:], -cosine
    angle = float(np.arccos(min(cosine, 1.0)))
    weights = (1.0 - share, share)
    if angle > 1e-6:
        weights = (np.sin((1.0 - share) * angle) / np.sin(angle), np.sin(share * angle) / np.sin(angle))
    position = (1.0 - share) * one[:3] + share * other[:3]
    return matrix_from_pose(np.concatenate((position, weights[0] * one[3:] + weights[1] * other[3:])))
