# SPDX-License-Identifier: Apache-2.0
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from services.evaluation.trajectory.files import read_trajectory
from services.formats.kitti_poses import write_kitti_poses
from services.formats.trajectory import Trajectory
from services.formats.tum import write_tum
from services.runtime.errors import InputError

Drive = Callable[..., Trajectory]

TUM_ROW = "0.1 1 2 3 0 0 0 1"


def test_tum_comes_back_with_its_nanoseconds(tmp_path: Path, winding_drive: Drive) -> None:
    drive = winding_drive(20)
    # Unix time in ns does not fit a float: a reader through float would be off by about 100 ns.
    late = Trajectory(drive.timestamp_ns + 1_763_800_000_123_456_789, drive.world_from_camera)
    write_tum(late, tmp_path / "a.tum")
    back = read_trajectory(tmp_path / "a.tum")
    np.testing.assert_array_equal(back.timestamp_ns, late.timestamp_ns)
    np.testing.assert_allclose(back.world_from_camera, late.world_from_camera, atol=1e-8)


def test_kitti_comes_back(tmp_path: Path, winding_drive: Drive) -> None:
    drive = winding_drive(20)
    write_kitti_poses(drive, tmp_path / "00.txt")
    back = read_trajectory(tmp_path / "00.txt", rate_hz=10.0)
    np.testing.assert_array_equal(back.timestamp_ns, drive.timestamp_ns)
    np.testing.assert_allclose(back.world_from_camera, drive.world_from_camera, atol=1e-8)


def test_kitti_takes_the_times_beside_it(tmp_path: Path, winding_drive: Drive) -> None:
    write_kitti_poses(winding_drive(3), tmp_path / "poses.txt")
    (tmp_path / "times.txt").write_text("0\n1.036e-01\n2.072e-01\n3.108e-01\n")
    assert read_trajectory(tmp_path / "poses.txt").timestamp_ns.tolist() == [0, 103_600_000, 207_200_000]


def test_comments_and_commas_are_read(tmp_path: Path) -> None:
    (tmp_path / "a.tum").write_text("# timestamp tx ty tz qx qy qz qw\n\n" + TUM_ROW.replace(" ", ",") + "\n")
    assert read_trajectory(tmp_path / "a.tum").timestamp_ns.tolist() == [100_000_000]


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("", "holds no rows, expected a trajectory in TUM, KITTI or EuRoC format"),
        ("# nothing\n\n", "holds no rows, expected a trajectory in TUM, KITTI or EuRoC format"),
        ("1 2 3\n", r"a\.txt:1: 3 numbers, expected 8 \(TUM\), 12 \(KITTI\) or 8 or 17 \(EuRoC \.csv\)"),
        (f"{TUM_ROW}\n0.2 1 2 3 0 0 1\n", r"a\.txt:2: 7 numbers, expected 8"),
        ("0.1 1 2 three 0 0 0 1\n", r"a\.txt:1: tz 'three', expected a finite number"),
        ("0.1 1 nan 3 0 0 0 1\n", r"a\.txt:1: ty 'nan', expected a finite number"),
        ("nan 1 2 3 0 0 0 1\n", r"a\.txt:1: time 'nan', expected seconds"),
        ("1e300 1 2 3 0 0 0 1\n", r"a\.txt:1: time '1e300', expected seconds"),
        ("0.1 1 2 3 0 0 0 0\n", r"a\.txt:1: quaternion of length 0, expected 1"),
        (f"{TUM_ROW}\n{TUM_ROW}\n", "time 100000000 ns of pose 2 is not after"),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n", "hold no times"),
    ],
)
def test_nonsense_is_one_clear_line(tmp_path: Path, content: str, expected: str) -> None:
    (tmp_path / "a.txt").write_text(content)
    with pytest.raises(InputError, match=expected) as raised:
        read_trajectory(tmp_path / "a.txt")
    assert "\n" not in str(raised.value)


def test_a_missing_and_a_binary_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_trajectory(tmp_path / "none.tum")
    (tmp_path / "b.tum").write_bytes(b"\x89PNG\xff\xfe\x00")
    with pytest.raises(InputError, match="not a readable text file"):
        read_trajectory(tmp_path / "b.tum")
    with pytest.raises(InputError, match="not a readable text file"):
        read_trajectory(tmp_path)


def test_fewer_times_than_poses_and_a_bad_rate_are_refused(tmp_path: Path, winding_drive: Drive) -> None:
    write_kitti_poses(winding_drive(3), tmp_path / "poses.txt")
    (tmp_path / "t.txt").write_text("0\n0.1\n")
    with pytest.raises(InputError, match="2 times for the 3 poses"):
        read_trajectory(tmp_path / "poses.txt", times=tmp_path / "t.txt")
    with pytest.raises(InputError, match="rate -1"):
        read_trajectory(tmp_path / "poses.txt", rate_hz=-1.0)
