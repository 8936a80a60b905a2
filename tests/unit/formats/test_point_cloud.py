# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest

from services.formats.point_cloud import LabelledPoints, first_in_voxels, read_points
from services.runtime.errors import InputError

PCD = (
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb state\nSIZE 4 4 4 4 1\nTYPE F F F U U\nCOUNT 1 1 1 1 1\n"
    "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA {}\n"
)
PLY = (
    "ply\nformat {} 1.0\ncomment made up\nelement vertex 2\nproperty float x\nproperty double y\nproperty float z\n"
    "property uchar state\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
)
ROWS = [(1.5, 2.0, -3.0, 0), (4.0, 5.25, 6.0, 2)]


def _assert_rows(points: LabelledPoints) -> None:
    np.testing.assert_array_equal(points.position, [row[:3] for row in ROWS])
    assert points.state.tolist() == [0, 2]


def _pcd_rows() -> bytes:
    dtype = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<u4"), ("state", "u1")])
    return np.array([(x, y, z, 7, state) for x, y, z, state in ROWS], dtype).tobytes()


def test_pcd_is_read_binary_and_ascii(tmp_path: Path) -> None:
    (tmp_path / "a.pcd").write_bytes(PCD.format("binary").encode() + _pcd_rows())
    _assert_rows(read_points(tmp_path / "a.pcd"))
    (tmp_path / "a.pcd").write_text(PCD.format("ascii") + "1.5 2 -3 7 0\n4 5.25 6 7 2\n")
    _assert_rows(read_points(tmp_path / "a.pcd"))


@pytest.mark.parametrize(("encoding", "order"), [("binary_little_endian", "<"), ("binary_big_endian", ">")])
def test_ply_is_read_in_both_byte_orders(tmp_path: Path, encoding: str, order: str) -> None:
    dtype = np.dtype([("x", f"{order}f4"), ("y", f"{order}f8"), ("z", f"{order}f4"), ("state", "u1")])
    (tmp_path / "a.ply").write_bytes(PLY.format(encoding).encode() + np.array(ROWS, dtype).tobytes() + b"\x03face")
    _assert_rows(read_points(tmp_path / "a.ply"))


def test_ply_is_read_as_text_with_label_for_state(tmp_path: Path) -> None:
    (tmp_path / "a.PLY").write_text(PLY.format("ascii").replace("state", "label") + "1.5 2 -3 0\n4 5.25 6 2\n3 0 1 1\n")
    _assert_rows(read_points(tmp_path / "a.PLY"))


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("a.xyz", "", r"expected points in a file whose name ends in \.pcd or \.ply"),
        ("a.pcd", "", "no header that ends with a line 'DATA', expected a PCD file"),
        ("a.pcd", PCD.format("binary_compressed"), "DATA binary_compressed, expected ascii or binary"),
        ("a.pcd", PCD.format("binary") + "123", "cut off, 3 bytes of points, expected 34 for 2 points"),
        ("a.pcd", PCD.format("ascii") + "1 2 3 4 0\n", "cut off, 1 rows, expected 2 points"),
        ("a.pcd", PCD.format("ascii") + "1 2 3 4 0\n1 2 3\n", "point 2 has 3 numbers, expected 5"),
        ("a.pcd", PCD.format("ascii") + "1 2 3 4 0\n1 2 c 4 0\n", "point 2: could not convert string to float: 'c'"),
        ("a.pcd", PCD.format("ascii") + "1 2 3 4 0\n1 nan 3 4 0\n", "point 2 of 2 is not finite"),
        ("a.pcd", PCD.format("ascii") + "1 2 3 4 0\n1 2 3 4 5\n", "state 5 of point 2, expected a MotionState, 0 to 4"),
        ("a.pcd", PCD.format("ascii").replace("SIZE 4 4 4 4 1", "SIZE 4 4"), "do not name as many different fields"),
        ("a.pcd", PCD.format("ascii").replace("SIZE 4", "SIZE 3"), "field x of TYPE F and SIZE 3"),
        ("a.pcd", PCD.format("ascii").replace("COUNT 1", "COUNT 3"), "COUNT 3 1 1 1 1, expected 1"),
        ("a.pcd", PCD.format("ascii").replace("POINTS 2", "POINTS -2"), "POINTS -2, expected a number of points"),
        ("a.pcd", PCD.format("ascii").replace("state", "intensity") + "1 2 3 4 0\n" * 2, "fields x y z rgb intensity"),
        ("a.ply", "plot\nend_header\n", "begins with 'plot', expected ply"),
        ("a.ply", PLY.format("utf8"), "format 'utf8', expected one of ascii"),
        ("a.ply", PLY.format("ascii").replace("vertex 2", "vertex x"), "element vertex x, expected a number"),
        ("a.ply", PLY.format("ascii").replace("vertex 2", "edge 2"), "its first element is no vertex"),
        ("a.ply", PLY.format("ascii").replace("uchar state", "list uchar int n"), "'property list uchar int n'"),
        ("a.ply", PLY.format("ascii").replace("double y", "float x"), "no properties or one twice"),
    ],
)
def test_nonsense_is_one_clear_line(tmp_path: Path, name: str, content: str, expected: str) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(InputError, match=expected) as raised:
        read_points(tmp_path / name)
    assert "\n" not in str(raised.value)
    assert name in str(raised.value)


def test_a_missing_file_and_unequal_arrays_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        read_points(tmp_path / "none.ply")
    with pytest.raises(InputError, match=r"positions of shape \(3, 3\), expected \(2, 3\)"):
        LabelledPoints(np.zeros((3, 3)), np.zeros(2, np.uint8))


@pytest.mark.parametrize(
    ("point", "expected"),
    [
        ("0 0 0 256", "state 256 of point 1, expected a whole number in 0..255"),
        ("0 0 0 -1", "state -1 of point 1"),
        ("0 0 0 nan", "state nan of point 1"),
        ("0 0 0 1.5", "state 1.5 of point 1"),
        ("1e300 0 0 0", "point 1 of 1 is not finite"),
        ("1e30 0 0 0", "is at 1e.30 m, expected at most 1e.09"),
    ],
)
def test_numbers_that_their_type_cannot_hold(tmp_path: Path, point: str, expected: str) -> None:
    header = "VERSION 0.7\nFIELDS x y z state\nSIZE 4 4 4 1\nTYPE F F F U\nPOINTS 1\nDATA ascii\n"
    (tmp_path / "map.pcd").write_text(f"{header}{point}\n")
    with pytest.raises(InputError, match=expected):
        read_points(tmp_path / "map.pcd")


def test_the_first_point_of_every_state_in_every_cube() -> None:
    position = np.array([[0.0, 0, 0], [0.4, 0, 0], [0.6, 0, 0], [0.4, 0, 0], [-0.1, 0, 0]])
    state = np.array([0, 0, 0, 1, 0], dtype=np.uint8)
    assert first_in_voxels(position, state, 0.5).tolist() == [0, 2, 3, 4]
    assert first_in_voxels(position[:0], state[:0], 0.5).tolist() == []
    with pytest.raises(InputError, match="voxel 1e-09 m, expected a larger one"):
        first_in_voxels(np.eye(3), np.zeros(3, dtype=np.uint8), 1e-9)
