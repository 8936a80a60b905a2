# SPDX-License-Identifier: Apache-2.0
"""Trajectories with known answers."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.evaluation.trajectory.alignment import Similarity
from services.formats.trajectory import Trajectory


def _winding_drive(count: int = 120, seed: int = 3, name: str = "truth") -> Trajectory:
    """A drive of about a metre a frame with curves and slopes, at 10 Hz."""
    rng = np.random.default_rng(seed)
    heading = np.cumsum(rng.normal(0.0, 0.03, count)) + np.linspace(0.0, 1.5, count)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = Rotation.from_euler("yx", np.stack((heading, rng.normal(0.0, 0.01, count)), axis=1)).as_matrix()
    steps = np.stack((np.sin(heading), 0.02 * rng.normal(size=count), np.cos(heading)), axis=1)
    poses[:, :3, 3] = np.cumsum(steps, axis=0)
    return Trajectory(np.arange(count, dtype=np.int64) * 100_000_000, poses, name)


def _seen_from_elsewhere(
    truth: Trajectory, target_from_source: Similarity, noise_m: float = 0.0, seed: int = 5
) -> Trajectory:
    """The same drive in another frame: truth = target_from_source * estimate, noise added in the truth's frame."""
    noisy = truth.world_from_camera.copy()
    noisy[:, :3, 3] += np.random.default_rng(seed).normal(0.0, noise_m, (len(truth), 3)) if noise_m else 0.0
    inverse = Similarity(
        target_from_source.rotation.T,
        -target_from_source.rotation.T @ target_from_source.translation / target_from_source.scale,
        1.0 / target_from_source.scale,
    )
    return Trajectory(truth.timestamp_ns, inverse.poses(noisy), "estimate")


@pytest.fixture
def winding_drive() -> Callable[..., Trajectory]:
    """A drive of about a metre a frame with curves and slopes, at 10 Hz."""
    return _winding_drive


@pytest.fixture
def seen_from_elsewhere() -> Callable[..., Trajectory]:
    """The same drive in another frame, with noise."""
    return _seen_from_elsewhere
