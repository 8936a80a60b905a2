# SPDX-License-Identifier: Apache-2.0
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from services.evaluation.trajectory.association import match_by_time
from services.formats.trajectory import Trajectory
from services.runtime.errors import InputError

Drive = Callable[..., Trajectory]


def _at(times_ns: list[int]) -> Trajectory:
    return Trajectory(np.array(times_ns, dtype=np.int64), np.tile(np.eye(4), (len(times_ns), 1, 1)))


_TIMES = st.lists(st.integers(0, 200), unique=True, max_size=25).map(sorted)


@given(estimate=_TIMES, truth=_TIMES, tolerance=st.integers(0, 30))
def test_matches_are_mutual_nearest_within_the_tolerance(estimate: list[int], truth: list[int], tolerance: int) -> None:
    matches = match_by_time(_at(estimate), _at(truth), tolerance)
    assert len(set(matches.truth_index.tolist())) == len(matches.truth_index)
    assert (np.diff(matches.estimate_index) > 0).all()
    assert (np.diff(matches.truth_index) > 0).all()
    pairs = dict(zip(matches.estimate_index.tolist(), matches.truth_index.tolist(), strict=True))
    for row, time in enumerate(estimate):
        gaps = [abs(time - other) for other in truth]
        if row in pairs:
            assert gaps[pairs[row]] == min(gaps) <= tolerance
        elif gaps and min(gaps) <= tolerance:
            # Left out although a truth is near: that truth went to an estimate at least as near to it.
            nearest = {index for index, gap in enumerate(gaps) if gap == min(gaps)}
            taken = [abs(estimate[other] - truth[index]) for other, index in pairs.items() if index in nearest]
            assert taken
            assert min(taken) <= min(gaps)


def test_nan_pose_is_refused_by_its_number(winding_drive: Drive) -> None:
    drive = winding_drive(10)
    poses = drive.world_from_camera.copy()
    poses[6, 1, 3] = np.nan
    with pytest.raises(InputError, match="truth: pose 7 of 10 is not finite"):
        Trajectory(drive.timestamp_ns, poses, "truth")


def test_a_matrix_that_is_no_rotation_is_refused(winding_drive: Drive) -> None:
    drive = winding_drive(10)
    poses = drive.world_from_camera.copy()
    poses[2, :3, :3] *= 1.1
    with pytest.raises(InputError, match="pose 3 of 10 is not a rotation"):
        Trajectory(drive.timestamp_ns, poses)


def test_a_reflection_is_refused() -> None:
    with pytest.raises(InputError, match="not a rotation"):
        Trajectory(np.array([0]), np.diag((1.0, 1.0, -1.0, 1.0))[None])


def test_time_that_goes_back_is_refused() -> None:
    with pytest.raises(InputError, match="time 5 ns of pose 3 is not after"):
        _at([0, 5, 5])


def test_length_is_along_the_path() -> None:
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, :3, 3] = [(0, 0, 0), (3, 4, 0), (3, 4, 12)]
    assert Trajectory(np.arange(3), poses).length_m == pytest.approx(17.0)
