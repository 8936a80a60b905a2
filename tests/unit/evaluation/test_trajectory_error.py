# SPDX-License-Identifier: Apache-2.0
import copy
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from evo.core import metrics, sync
from evo.core.trajectory import PoseTrajectory3D
from scipy.spatial.transform import Rotation

from services.evaluation.alignment import Alignment, Similarity
from services.evaluation.trajectory_error import trajectory_error
from services.evaluation.trajectory_files import read_trajectory
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError

Drive = Callable[..., Trajectory]

ELSEWHERE = Similarity(Rotation.from_euler("xyz", (0.4, -1.1, 2.0)).as_matrix(), np.array([30.0, -4.0, 11.0]), 7.3)


def _evo(trajectory: Trajectory) -> PoseTrajectory3D:
    return PoseTrajectory3D(poses_se3=list(trajectory.world_from_camera), timestamps=trajectory.timestamp_ns / 1e9)


def _part(trajectory: Trajectory, rows: np.ndarray, shift_ns: int = 0) -> Trajectory:
    return Trajectory(trajectory.timestamp_ns[rows] + shift_ns, trajectory.world_from_camera[rows], trajectory.name)


def test_a_perfect_estimate_in_another_frame_has_no_error(winding_drive: Drive, seen_from_elsewhere: Drive) -> None:
    truth = winding_drive()
    error = trajectory_error(seen_from_elsewhere(truth, ELSEWHERE), truth)
    assert error.absolute_m.max < 1e-9
    assert error.relative_m is not None
    assert error.relative_m.max < 1e-9
    assert error.relative_deg is not None
    assert error.relative_deg.max < 1e-4
    assert error.truth_from_estimate.scale == pytest.approx(7.3)
    assert error.coverage == 1.0


@pytest.mark.parametrize("alignment", list(Alignment))
@pytest.mark.parametrize("seed", range(4))
def test_agrees_with_evo(alignment: Alignment, seed: int, winding_drive: Drive, seen_from_elsewhere: Drive) -> None:
    truth = winding_drive(seed=seed)
    # A shift below the tolerance, and frames that were not tracked: matching is compared too.
    estimate = seen_from_elsewhere(truth, ELSEWHERE, noise_m=0.4, seed=seed)
    estimate = _part(estimate, np.flatnonzero(np.arange(len(truth)) % 7 != 3), shift_ns=4_000_000)
    error = trajectory_error(estimate, truth, alignment)

    reference, other = sync.associate_trajectories(_evo(truth), _evo(estimate), max_diff=0.01)
    other = copy.deepcopy(other)
    if alignment is not Alignment.NONE:
        other.align(reference, correct_scale=alignment is Alignment.SIM3)
    ape = metrics.APE(metrics.PoseRelation.translation_part)
    ape.process_data((reference, other))
    for name, value in (
        ("rmse", error.absolute_m.rmse),
        ("mean", error.absolute_m.mean),
        ("max", error.absolute_m.max),
    ):
        assert value == pytest.approx(ape.get_all_statistics()[name], abs=1e-6)
    assert error.absolute_m.median == pytest.approx(ape.get_statistic(metrics.StatisticsType.median), abs=1e-6)


def test_relative_error_agrees_with_evo(winding_drive: Drive, seen_from_elsewhere: Drive) -> None:
    truth = winding_drive()
    estimate = seen_from_elsewhere(truth, ELSEWHERE, noise_m=0.1)
    error = trajectory_error(estimate, truth, Alignment.SIM3, delta_frames=5)
    aligned = _evo(estimate)
    aligned.align(_evo(truth), correct_scale=True)
    for relation, ours in (
        (metrics.PoseRelation.translation_part, error.relative_m),
        (metrics.PoseRelation.rotation_angle_deg, error.relative_deg),
    ):
        rpe = metrics.RPE(relation, delta=5, delta_unit=metrics.Unit.frames, all_pairs=True)
        rpe.process_data((_evo(truth), aligned))
        assert ours is not None
        assert ours.rmse == pytest.approx(rpe.get_statistic(metrics.StatisticsType.rmse), abs=1e-6)


def test_real_poses_agree_with_evo(shared_data: Path, seen_from_elsewhere: Drive) -> None:
    folder = shared_data / "kitti"
    truth = read_trajectory(folder / "poses/03.txt", times=folder / "sequences/03/times.txt")
    estimate = seen_from_elsewhere(truth, ELSEWHERE, noise_m=1.0)
    aligned = _evo(estimate)
    aligned.align(_evo(truth), correct_scale=True)
    ape = metrics.APE(metrics.PoseRelation.translation_part)
    ape.process_data((_evo(truth), aligned))
    ours = trajectory_error(estimate, truth).absolute_m.rmse
    assert ours == pytest.approx(ape.get_statistic(metrics.StatisticsType.rmse), abs=1e-6)


def test_coverage_says_what_was_left_out(winding_drive: Drive) -> None:
    truth = winding_drive(100)
    error = trajectory_error(_part(truth, np.arange(40, 100)), truth, frames=120)
    assert error.coverage == pytest.approx(0.5)


def test_relative_error_skips_pairs_across_lost_frames(winding_drive: Drive) -> None:
    truth = winding_drive(60)
    # Frames 20 to 39 were lost, and tracking went on elsewhere: no one-frame motion is wrong by that.
    rows = np.r_[0:20, 40:60]
    moved = truth.world_from_camera[rows].copy()
    moved[20:, :3, 3] += 50.0
    error = trajectory_error(Trajectory(truth.timestamp_ns[rows], moved), truth, Alignment.NONE)
    assert error.relative_m is not None
    assert error.relative_m.max < 1e-9
    assert error.absolute_m.max > 80.0


def test_no_overlap_in_time_names_both_spans(winding_drive: Drive) -> None:
    truth = winding_drive()
    late = _part(truth, np.arange(len(truth)), shift_ns=3_600_000_000_000)
    with pytest.raises(InputError, match=r"0 poses of truth \(3600\.000 to 3611\.900 s\).*0\.000 to 11\.900 s"):
        trajectory_error(late, truth)


@pytest.mark.parametrize(
    ("rows", "expected"),
    [(np.arange(0), "0 poses, expected at least 3"), (np.arange(2), "2 poses, expected at least 3")],
)
def test_too_few_poses_are_refused(rows: np.ndarray, expected: str, winding_drive: Drive) -> None:
    truth = winding_drive()
    with pytest.raises(InputError, match=expected):
        trajectory_error(_part(truth, rows), truth)


def test_standing_still_is_refused(winding_drive: Drive) -> None:
    truth = winding_drive()
    still = Trajectory(truth.timestamp_ns, np.tile(np.eye(4), (len(truth), 1, 1)))
    with pytest.raises(InputError, match="at one place"):
        trajectory_error(still, truth)
