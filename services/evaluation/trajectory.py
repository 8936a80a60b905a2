# SPDX-License-Identifier: Apache-2.0
"""A camera's path over time, and which poses of two paths belong to the same moment."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError

DEFAULT_MATCH_NS = 10_000_000

# A rotation read from a text file of six or more digits is orthogonal to about this.
_ORTHOGONALITY_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Trajectory:
    """Poses in the order of time.

    `timestamp_ns` is (N,) int64, strictly increasing; `world_from_camera` is (N, 4, 4), camera frame optical. `name`
    says in errors which trajectory is meant.

    Raises InputError for poses that are not finite, not rigid, or out of order.
    """

    timestamp_ns: npt.NDArray[np.int64]
    world_from_camera: npt.NDArray[np.float64]
    name: str = "trajectory"

    def __post_init__(self) -> None:
        count = len(self.timestamp_ns)
        if self.world_from_camera.shape != (count, 4, 4):
            raise InputError(
                f"{self.name}: poses of shape {self.world_from_camera.shape}, expected ({count}, 4, 4) as it has times"
            )
        broken = ~np.isfinite(self.world_from_camera).all(axis=(1, 2))
        if broken.any():
            raise InputError(f"{self.name}: pose {int(np.argmax(broken)) + 1} of {count} is not finite")
        rotation = self.world_from_camera[:, :3, :3]
        skew = np.abs(rotation @ rotation.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2), initial=0.0)
        skew = np.maximum(skew, np.abs(np.linalg.det(rotation) - 1.0) if count else skew)
        if count and skew.max() > _ORTHOGONALITY_TOLERANCE:
            worst = int(np.argmax(skew))
            raise InputError(f"{self.name}: pose {worst + 1} of {count} is not a rotation (off by {skew[worst]:.3g})")
        steps = np.diff(self.timestamp_ns)
        if (steps <= 0).any():
            later = int(np.argmax(steps <= 0)) + 1
            raise InputError(
                f"{self.name}: time {self.timestamp_ns[later]} ns of pose {later + 1} is not after the one before it"
            )

    def __len__(self) -> int:
        return len(self.timestamp_ns)

    @property
    def positions_m(self) -> npt.NDArray[np.float64]:
        """(N, 3), the camera's centre in the world frame."""
        return self.world_from_camera[:, :3, 3]

    @property
    def length_m(self) -> float:
        """Metres (or map units) along the path."""
        return float(np.linalg.norm(np.diff(self.positions_m, axis=0), axis=1).sum())


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
