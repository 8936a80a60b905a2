# SPDX-License-Identifier: Apache-2.0
"""KITTI's segment errors against the benchmark's formula written down once more, frame by frame."""

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.evaluation.trajectory.alignment import Alignment
from services.evaluation.trajectory.error import trajectory_error
from services.evaluation.trajectory.files import read_trajectory
from services.formats.trajectory import Trajectory

Drive = Callable[..., Trajectory]
Segment = tuple[int, float, float]


def _segments_one_by_one(truth: np.ndarray, estimate: dict[int, np.ndarray]) -> list[Segment]:
    """(length, translation error a metre, rotation error in rad a metre) of every segment, as the benchmark says it."""
    way = [0.0]
    for before, after in pairwise(truth):
        way.append(way[-1] + math.dist(before[:3, 3], after[:3, 3]))
    found = []
    for first in range(0, len(truth), 10):
        for length in range(100, 801, 100):
            last = next((row for row in range(first, len(truth)) if way[row] > way[first] + length), None)
            if last is None or first not in estimate or last not in estimate:
                continue
            true_motion = np.linalg.inv(truth[first]) @ truth[last]
            motion = np.linalg.inv(estimate[first]) @ estimate[last]
            rest = np.linalg.inv(motion) @ true_motion
            cosine = min(1.0, max(-1.0, 0.5 * (rest[0, 0] + rest[1, 1] + rest[2, 2] - 1.0)))
            found.append((length, float(np.linalg.norm(rest[:3, 3])) / length, math.acos(cosine) / length))
    return found


def _drifting(truth: Trajectory, seed: int = 1) -> Trajectory:
    """Each motion a little too long and a little turned, as odometry is."""
    rng = np.random.default_rng(seed)
    poses = [np.eye(4)]
    for before, after in pairwise(truth.world_from_camera):
        motion = np.linalg.inv(before) @ after
        motion[:3, :3] = Rotation.from_rotvec(rng.normal(0.0, 0.002, 3)).as_matrix() @ motion[:3, :3]
        motion[:3, 3] *= 1.02
        poses.append(poses[-1] @ motion)
    return Trajectory(truth.timestamp_ns, np.array(poses), "odometry")


def _assert_same(truth: Trajectory, estimate: Trajectory, rows: np.ndarray, possible: int) -> None:
    error = trajectory_error(estimate, truth, Alignment.NONE)
    expected = _segments_one_by_one(
        truth.world_from_camera, dict(zip(rows.tolist(), estimate.world_from_camera, strict=True))
    )
    assert len(expected) > 15
    overall = error.segments.overall
    assert (overall.segments, overall.possible) == (len(expected), possible)
    assert overall.translation_percent == pytest.approx(100 * np.mean([row[1] for row in expected]), abs=1e-9)
    assert overall.rotation_deg_per_m == pytest.approx(np.degrees(np.mean([row[2] for row in expected])), abs=1e-9)
    for of_length in error.segments.by_length:
        chosen = [row for row in expected if row[0] == of_length.length_m]
        assert of_length.segments == len(chosen)
        if chosen:
            assert of_length.translation_percent == pytest.approx(100 * np.mean([row[1] for row in chosen]), abs=1e-9)


def test_every_length_agrees_on_a_long_drive(winding_drive: Drive) -> None:
    truth = winding_drive(950)
    everywhere = np.arange(len(truth))
    possible = len(_segments_one_by_one(truth.world_from_camera, dict(enumerate(truth.world_from_camera))))
    _assert_same(truth, _drifting(truth), everywhere, possible)
    tracked = np.flatnonzero((everywhere % 20 != 0) | (everywhere < 300))
    odometry = _drifting(truth)
    part = Trajectory(truth.timestamp_ns[tracked], odometry.world_from_camera[tracked], "odometry")
    _assert_same(truth, part, tracked, possible)


def test_agrees_on_a_real_drive(shared_data: Path) -> None:
    folder = shared_data / "kitti"
    truth = read_trajectory(folder / "poses/03.txt", times=folder / "sequences/03/times.txt")
    possible = len(_segments_one_by_one(truth.world_from_camera, dict(enumerate(truth.world_from_camera))))
    _assert_same(truth, _drifting(truth), np.arange(len(truth)), possible)


def test_of_the_alignment_only_the_scale_counts(winding_drive: Drive) -> None:
    truth = winding_drive(400)
    odometry = _drifting(truth)
    none, se3, sim3 = (trajectory_error(odometry, truth, alignment).segments.overall for alignment in Alignment)
    assert none.translation_percent == pytest.approx(se3.translation_percent, abs=1e-9)
    assert sim3.translation_percent != pytest.approx(se3.translation_percent, abs=1e-3)


def test_a_drive_of_less_than_100_m_has_no_segment(winding_drive: Drive) -> None:
    overall = trajectory_error(winding_drive(90), winding_drive(90)).segments.overall
    assert (overall.possible, overall.segments, overall.translation_percent) == (0, 0, None)
    assert overall.coverage == 0.0
