# SPDX-License-Identifier: Apache-2.0
"""A map brought into the frame of its ground truth by the camera path that was exported with it."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.evaluation.trajectory.alignment import MINIMUM_POSES, Alignment, Similarity
from services.evaluation.trajectory.association import DEFAULT_MATCH_NS, match_by_time
from services.evaluation.trajectory.pose_alignment import align_poses
from services.formats.point_cloud import LabelledPoints
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError


@dataclass(frozen=True)
class MapAlignment:
    """`truth_from_map`, found over `poses` of the true ones."""

    alignment: Alignment
    truth_from_map: Similarity
    poses: int
    truth: Trajectory

    @property
    def path_m(self) -> npt.NDArray[np.float64]:
        """(N, 3) true positions of the camera."""
        return self.truth.positions_m

    def described(self) -> str:
        """In one line, with the share of the true poses that it was found over."""
        covered = f"{self.poses} of {len(self.truth)} poses ({self.poses / len(self.truth):.1%})"
        return f"{self.alignment.value}, scale {self.truth_from_map.scale:.4g}, by {covered}"

    def points(self, landmarks: LabelledPoints) -> LabelledPoints:
        """The landmarks in the frame of the truth."""
        return LabelledPoints(self.truth_from_map.points(landmarks.position), landmarks.state, landmarks.name)


def map_alignment(estimate: Trajectory, truth: Trajectory, alignment: Alignment) -> MapAlignment:
    """Raises InputError where fewer than 3 poses are of the same time, or they are all at one place."""
    matches = match_by_time(estimate, truth, DEFAULT_MATCH_NS)
    count = len(matches.estimate_index)
    if count < MINIMUM_POSES:
        raise InputError(
            f"{count} poses of {estimate.name} are within {DEFAULT_MATCH_NS / 1e6:g} ms of {truth.name},"
            f" expected at least {MINIMUM_POSES}"
        )
    truth_from_map = align_poses(
        estimate.world_from_camera[matches.estimate_index], truth.world_from_camera[matches.truth_index], alignment
    )
    return MapAlignment(alignment, truth_from_map, count, truth)
