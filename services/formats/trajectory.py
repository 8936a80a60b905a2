# SPDX-License-Identifier: Apache-2.0
"""A camera's path over time, whichever file it came from."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError

# A rotation read from a text file of six or more digits is orthogonal to about this.
_ORTHOGONALITY_TOLERANCE = 1e-3
# Beyond this the squares that errors are made of lose what is near, and further on overflow.
_FARTHEST_M = 1e9
_RATES_HZ = (1e-3, 1e4)


@dataclass(frozen=True)
class Trajectory:
    """Poses in the order of time.

    `timestamp_ns` is (N,) int64, strictly increasing; `world_from_camera` is (N, 4, 4), camera frame optical. `name`
    says in errors which trajectory is meant.

    Raises InputError for poses that are not finite, farther than 10^9 m from the origin, not rigid, or out of order.
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
        far = (np.abs(self.world_from_camera[:, :3, 3]) > _FARTHEST_M).any(axis=1)
        if far.any():
            row = int(np.argmax(far))
            largest = float(np.abs(self.world_from_camera[row, :3, 3]).max())
            raise InputError(
                f"{self.name}: pose {row + 1} of {count} is at {largest:.3g} m, expected at most {_FARTHEST_M:g}"
            )
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
                f"{self.name}: time {self.timestamp_ns[later]} ns of pose {later + 1} is not after"
                f" {self.timestamp_ns[later - 1]} ns of the one before it, expected poses in the order of time"
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


def period_ns(rate_hz: float) -> float:
    """Nanoseconds from frame to frame. Raises InputError for a rate outside 0.001 to 10000 Hz."""
    slowest, fastest = _RATES_HZ
    if not slowest <= rate_hz <= fastest:
        raise InputError(f"rate {rate_hz:g} Hz, expected {slowest:g} to {fastest:g}")
    return 1e9 / rate_hz
