# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from services.evaluation.trajectory.files import read_trajectory
from services.formats.euroc import read_body_from_sensor, read_euroc, write_euroc
from services.formats.trajectory import Trajectory
from services.formats.tum import write_tum
from services.runtime.errors import InputError

# The form of the data set's own files: header, nanoseconds, position, quaternion w first, velocity, biases.
STATE = (
    "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v, b_w, b_a\n"
    "1403636580838555648,4.688319,-1.786938,0.783338,0.5,0.5,-0.5,0.5,0,0,0,-0.002,0.02,0.07,-0.01,0.1,0.08\n"
    "1403636580843555648,4.688177,-1.786770,0.787350,0,0,0,1,0,0,0,-0.002,0.02,0.07,-0.01,0.1,0.08\n"
)
SENSOR = """%YAML:1.0
sensor_type: camera
T_BS:
  cols: 4
  rows: 4
  data: [0.0, -1.0, 0.0, 0.1,
         1.0, 0.0, 0.0, 0.2,
         0.0, 0.0, 1.0, 0.3,
         0.0, 0.0, 0.0, 1.0]
rate_hz: 20
"""


def _drive(count: int = 9) -> Trajectory:
    rng = np.random.default_rng(1)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = Rotation.random(count, rng=rng).as_matrix()
    poses[:, :3, 3] = rng.normal(scale=10.0, size=(count, 3))
    return Trajectory(1_403_636_580_838_555_648 + 50_000_000 * np.arange(count), poses)


def test_a_state_file_has_w_first_and_whole_nanoseconds(tmp_path: Path) -> None:
    (tmp_path / "data.csv").write_text(STATE)
    body = read_euroc(tmp_path / "data.csv")
    assert body.timestamp_ns.tolist() == [1403636580838555648, 1403636580843555648]
    np.testing.assert_allclose(body.positions_m[1], (4.688177, -1.786770, 0.787350))
    expected = Rotation.from_quat((0.5, -0.5, 0.5, 0.5)).as_matrix()
    np.testing.assert_allclose(body.world_from_camera[0, :3, :3], expected, atol=1e-12)
    np.testing.assert_allclose(body.world_from_camera[1, :3, :3], np.diag((-1.0, -1.0, 1.0)), atol=1e-12)


def test_a_trajectory_comes_back(tmp_path: Path) -> None:
    drive = _drive()
    write_euroc(drive, tmp_path / "a.csv")
    for back in (read_euroc(tmp_path / "a.csv"), read_trajectory(tmp_path / "a.csv")):
        np.testing.assert_array_equal(back.timestamp_ns, drive.timestamp_ns)
        np.testing.assert_allclose(back.world_from_camera, drive.world_from_camera, atol=1e-8)


def test_the_sensor_sits_on_the_body(tmp_path: Path) -> None:
    drive = _drive()
    write_euroc(drive, tmp_path / "a.csv")
    (tmp_path / "sensor.yaml").write_text(SENSOR)
    body_from_sensor = read_body_from_sensor(tmp_path / "sensor.yaml")
    np.testing.assert_array_equal(body_from_sensor[:3, 3], (0.1, 0.2, 0.3))
    camera = read_trajectory(tmp_path / "a.csv", body_from_sensor=body_from_sensor)
    in_body = np.array([0.1, 0.2, 0.3])
    expected = drive.world_from_camera[:, :3, :3] @ in_body + drive.positions_m
    np.testing.assert_allclose(camera.positions_m, expected, atol=1e-7)


def test_columns_and_name_tell_the_format(tmp_path: Path) -> None:
    (tmp_path / "state.txt").write_text(STATE)
    assert len(read_trajectory(tmp_path / "state.txt")) == 2
    write_tum(_drive(), tmp_path / "a.tum")
    with pytest.raises(InputError, match=r"for EuRoC's poses of the body, expected an EuRoC \.csv"):
        read_trajectory(tmp_path / "a.tum", body_from_sensor=np.eye(4))


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("#timestamp\n", "holds no rows, expected a trajectory in EuRoC format"),
        ("1.5,0,0,0,1,0,0,0\n", r"a\.csv:1: time '1\.5', expected whole nanoseconds"),
        ("-5,0,0,0,1,0,0,0\n", r"a\.csv:1: time '-5', expected whole nanoseconds"),
        ("99999999999999999999,0,0,0,1,0,0,0\n", "expected whole nanoseconds"),
        ("1,0,inf,0,1,0,0,0\n", r"a\.csv:1: py 'inf', expected a finite number"),
        ("1,0,0,0,1,1,0,0\n", r"a\.csv:1: quaternion of length 1\.41, expected 1"),
        ("1,0,0,0,1,0,0\n", r"a\.csv:1: 7 numbers, expected 8 or 17"),
        ("1,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n", "time 1 ns of pose 2 is not after"),
    ],
)
def test_nonsense_is_one_clear_line(tmp_path: Path, content: str, expected: str) -> None:
    (tmp_path / "a.csv").write_text(content)
    with pytest.raises(InputError, match=expected) as raised:
        read_euroc(tmp_path / "a.csv")
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        ("rate_hz: 20\n", "holds no T_BS"),
        ("T_BS:\n  data: [1, 0, 0]\n", "T_BS has 3 numbers, expected 16"),
        (SENSOR.replace("0.3", "x"), "T_BS holds what is no number"),
        (SENSOR.replace("-1.0", "-2.0"), "T_BS is not a rigid transform"),
        (SENSOR.replace("0.0, -1.0", "0.0, 1.0"), "T_BS is not a rigid transform"),
    ],
)
def test_a_sensor_file_without_a_transform_is_refused(tmp_path: Path, content: str, expected: str) -> None:
    (tmp_path / "sensor.yaml").write_text(content)
    with pytest.raises(InputError, match=expected):
        read_body_from_sensor(tmp_path / "sensor.yaml")
    with pytest.raises(InputError, match="cannot be read"):
        read_body_from_sensor(tmp_path / "none.yaml")
