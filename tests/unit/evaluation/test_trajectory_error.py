# SPDX-License-Identifier: Apache-2.0
import copy
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.evaluation.trajectory.alignment import Alignment, Similarity
from services.evaluation.trajectory.error import trajectory_error
from services.evaluation.trajectory.files import read_trajectory
from services.evaluation.trajectory.relative_error import path_pairs
from services.evaluation.trajectory.statistics import ErrorStatistics
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError

pytest.importorskip("evo", reason="evo is the reference here; it is GPL, and installed for tests only")
from evo.core import metrics, sync
from evo.core.trajectory import PoseTrajectory3D

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
    assert error.by_frames.translation_m is not None
    assert error.by_frames.translation_m.max < 1e-9
    assert error.by_frames.rotation_deg is not None
    assert error.by_frames.rotation_deg.max < 1e-4
    assert error.truth_from_estimate.scale == pytest.approx(7.3)
    assert error.coverage == 1.0


def _assert_statistics(ours: ErrorStatistics | None, theirs: metrics.PE) -> None:
    assert ours is not None
    expected = theirs.get_all_statistics()
    for name, value in asdict(ours).items():
        assert value == pytest.approx(expected[name], abs=1e-6), name


def _aligned_in_evo(
    estimate: Trajectory, truth: Trajectory, alignment: Alignment
) -> tuple[PoseTrajectory3D, PoseTrajectory3D]:
    reference, other = sync.associate_trajectories(_evo(truth), _evo(estimate), max_diff=0.01)
    other = copy.deepcopy(other)
    if alignment is not Alignment.NONE:
        other.align(reference, correct_scale=alignment is Alignment.SIM3)
    return reference, other


@pytest.mark.parametrize("alignment", list(Alignment))
@pytest.mark.parametrize("seed", range(4))
def test_agrees_with_evo(alignment: Alignment, seed: int, winding_drive: Drive, seen_from_elsewhere: Drive) -> None:
    truth = winding_drive(seed=seed)
    # A shift below the tolerance, and frames that were not tracked: matching is compared too.
    estimate = seen_from_elsewhere(truth, ELSEWHERE, noise_m=0.4, seed=seed)
    estimate = _part(estimate, np.flatnonzero(np.arange(len(truth)) % 7 != 3), shift_ns=4_000_000)
    error = trajectory_error(estimate, truth, alignment)
    ape = metrics.APE(metrics.PoseRelation.translation_part)
    ape.process_data(_aligned_in_evo(estimate, truth, alignment))
    _assert_statistics(error.absolute_m, ape)


@pytest.mark.parametrize("alignment", list(Alignment))
@pytest.mark.parametrize("unit", [metrics.Unit.frames, metrics.Unit.meters])
@pytest.mark.parametrize("delta", [1, 5, 20])
def test_relative_error_agrees_with_evo(
    delta: int, unit: metrics.Unit, alignment: Alignment, winding_drive: Drive, seen_from_elsewhere: Drive
) -> None:
    truth = winding_drive(seed=delta)
    estimate = seen_from_elsewhere(truth, ELSEWHERE, noise_m=0.1)
    error = trajectory_error(estimate, truth, alignment, delta_frames=delta, delta_m=float(delta))
    ours = error.by_frames if unit is metrics.Unit.frames else error.by_path
    for relation, statistics in (
        (metrics.PoseRelation.translation_part, ours.translation_m),
        (metrics.PoseRelation.rotation_angle_deg, ours.rotation_deg),
    ):
        rpe = metrics.RPE(relation, delta=delta, delta_unit=unit, all_pairs=True, pairs_from_reference=True)
        rpe.process_data(_aligned_in_evo(estimate, truth, alignment))
        assert ours.pairs == ours.possible == len(rpe.error)
        _assert_statistics(statistics, rpe)


@pytest.mark.parametrize("alignment", list(Alignment))
def test_real_poses_agree_with_evo(shared_data: Path, alignment: Alignment, seen_from_elsewhere: Drive) -> None:
    folder = shared_data / "kitti"
    truth = read_trajectory(folder / "poses/03.txt", times=folder / "sequences/03/times.txt")
    estimate = seen_from_elsewhere(truth, ELSEWHERE, noise_m=1.0)
    error = trajectory_error(estimate, truth, alignment, delta_m=25.0)
    pair = _aligned_in_evo(estimate, truth, alignment)
    ape = metrics.APE(metrics.PoseRelation.translation_part)
    ape.process_data(pair)
    _assert_statistics(error.absolute_m, ape)
    for delta, unit, ours in (
        (1, metrics.Unit.frames, error.by_frames.translation_m),
        (25, metrics.Unit.meters, error.by_path.translation_m),
    ):
        rpe = metrics.RPE(metrics.PoseRelation.translation_part, delta, unit, all_pairs=True, pairs_from_reference=True)
        rpe.process_data(pair)
        _assert_statistics(ours, rpe)


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
    assert error.by_frames.translation_m is not None
    assert error.by_frames.translation_m.max < 1e-9
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


def test_a_truth_that_stands_gives_no_scale(winding_drive: Drive) -> None:
    drive = winding_drive()
    still = Trajectory(drive.timestamp_ns, np.tile(np.eye(4), (len(drive), 1, 1)), "still")
    with pytest.raises(InputError, match="true positions are at one place: they give no scale"):
        trajectory_error(drive, still)
    assert trajectory_error(drive, still, Alignment.SE3).absolute_m.max > 1.0


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"delta_frames": 0}, "over 0 frames, expected 1 to"),
        ({"delta_m": float("nan")}, "over nan m, expected a number above 0"),
        ({"rate_hz": 0.0}, "rate 0 Hz"),
        ({"frames": 5}, "5 frames in the input, expected at least the 120"),
    ],
)
def test_options_out_of_range_are_refused(options: dict[str, float], expected: str, winding_drive: Drive) -> None:
    with pytest.raises(InputError, match=expected):
        trajectory_error(winding_drive(), winding_drive(), **options)  # type: ignore[arg-type]


def test_a_truth_denser_than_the_frames_says_what_was_lost(winding_drive: Drive) -> None:
    truth = winding_drive(201)  # at 10 Hz, for frames at 2 Hz: every fifth true pose is a frame
    frames = np.arange(0, 201, 5)
    tracked = frames[(frames < 50) | (frames >= 100)]
    error = trajectory_error(_part(truth, tracked), truth, Alignment.NONE, rate_hz=2.0)
    assert (error.frames, len(error.errors_m)) == (41, 31)
    assert (error.by_frames.possible, error.by_frames.pairs) == (40, 29)
    assert error.by_frames.translation_m is not None
    assert error.by_frames.translation_m.max < 1e-9


def test_a_camera_that_stands_pairs_with_the_first_frame_of_the_standing() -> None:
    path_m = np.array([0.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0])
    assert path_pairs(path_m, 2.0).tolist() == [[0, 2], [1, 5]]
    assert path_pairs(path_m, 1.0).tolist() == [[0, 1], [1, 2], [2, 5], [3, 5], [4, 5]]
    assert path_pairs(path_m, 9.0).tolist() == []
