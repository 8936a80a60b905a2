# SPDX-License-Identifier: Apache-2.0
"""The exported files, read by somebody else's reader where there is one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from schemas.records import MotionState
from services.formats.tum import read_tum
from services.mapstore.export import export_map
from services.mapstore.export.kitti import trajectory_kitti
from services.mapstore.export.pcd import POINT, map_pcd, points_of
from services.mapstore.export.tum import keyframes_tum, trajectory_tum
from services.mapstore.map_state import MapState
from services.mapstore.store import MapStore
from services.runtime.errors import InputError
from tests.unit.mapstore.street_map import (
    NO_DENSITY,
    PARKED_CAR,
    PASSING_CAR,
    drive,
    landmarks,
    state_of,
    tracked,
    view_of,
    waiting,
    with_keyframes,
)


def read_pcd(content: bytes) -> np.ndarray:
    header, data = content.split(b"DATA binary\n", 1)
    assert b"FIELDS x y z rgb state category object_id\nSIZE 4 4 4 4 1 4 4\n" in header
    return np.frombuffer(data, POINT)


def test_tum_rows_are_time_position_quaternion() -> None:
    view = view_of(7)
    _, first, *_, last = trajectory_tum(view, 1).splitlines()
    assert first == (
        "0.000000000 0.000000000 0.000000000 0.000000000 -0.500000000 0.500000000 -0.500000000 0.500000000"
    )
    assert last.startswith("0.600000000 6.000000000 0.000000000 0.000000000 ")
    assert [line.split()[0] for line in keyframes_tum(view, 1).splitlines()] == ["#", "0.000000000", "0.500000000"]


def test_tum_says_what_a_length_is(tmp_path: Path) -> None:
    view = view_of(3)
    arbitrary = trajectory_tum(replace(view, metric_scale=False), 1)
    assert arbitrary.startswith("# timestamp_s tx ty tz qx qy qz qw; map_from_camera, lengths in map units: the scale")
    metric = trajectory_tum(replace(view, metric_scale=True), 1)
    assert metric.splitlines()[0].endswith("lengths in metres")
    assert trajectory_tum(replace(view, map_id=2), 1).splitlines()[0].endswith("lengths in units of map 1")
    (tmp_path / "trajectory.tum").write_text(metric)
    assert len(read_tum(tmp_path / "trajectory.tum").timestamp_ns) == 3


def test_large_times_keep_every_nanosecond() -> None:
    state = MapState()
    state.add_frame(0, replace(tracked(0, 0), timestamp_ns=1_763_827_200_123_456_789))
    assert trajectory_tum(state.view(), 1).splitlines()[1].startswith("1763827200.123456789 ")


def test_frames_without_a_pose_are_left_out() -> None:
    state = MapState()
    state.add_frame(0, waiting(0))
    state.add_frame(1, tracked(1, 1))
    assert len(trajectory_tum(state.view(), 1).splitlines()) == 1 + 1
    assert trajectory_tum(MapState().view(), 0) == trajectory_kitti(MapState().view(), 0) == ""


def test_culled_keyframes_stay_in_the_trajectory_only() -> None:
    state = state_of(7)
    state.apply(with_keyframes(landmarks(0, 0, np.empty(0), np.empty((0, 3))), 5, culled=1))
    assert len(trajectory_tum(state.view(), 1).splitlines()) == 1 + 7
    assert len(keyframes_tum(state.view(), 1).splitlines()) == 1 + 1


def test_kitti_rows_begin_with_the_identity_and_look_along_z() -> None:
    rows = np.loadtxt(trajectory_kitti(view_of(7), 1).splitlines()).reshape(-1, 3, 4)
    np.testing.assert_allclose(rows[0], np.eye(4)[:3], atol=1e-12)
    np.testing.assert_allclose(rows[-1], np.hstack([np.eye(3), [[0], [0], [6]]]), atol=1e-9)


def test_pcd_has_every_landmark_by_id_in_its_colour() -> None:
    points = read_pcd(map_pcd(view_of(6), 1))
    assert len(points) == 80
    colours = {state: set(points["rgb"][points["state"] == state].tolist()) for state in (0, 1, 2)}
    assert colours == {0: {0x2E9E44}, 1: {0xF2C500}, 2: {0xE0312B}}
    assert set(points["object_id"].tolist()) == {0, PASSING_CAR, PARKED_CAR}
    assert set(points["category"][points["object_id"] > 0].tolist()) == {3}
    update = next(drive(1))[1]
    x, y, z = update.landmark_position[0]
    np.testing.assert_allclose([points[name][0] for name in "xyz"], [z, -x, -y], atol=1e-6)


def test_pcd_leaves_out_what_drove_off_but_keeps_what_moved() -> None:
    state = MapState()
    state.add_frame(0, tracked(0, 0))
    kinds = [MotionState.NON_MOVING, MotionState.NON_MOVING, MotionState.MOVING]
    state.apply(
        with_keyframes(landmarks(0, 0, np.arange(3), np.ones((3, 3)), state=kinds, valid_until_ns=[-1, 9, 9]), 0)
    )
    assert points_of(state.view(), 1)["state"].tolist() == [1, 2]


def test_pcd_opens_in_open3d(tmp_path: Path) -> None:
    open3d = pytest.importorskip("open3d", reason="open3d belongs to the simulator's extra")
    (tmp_path / "map.pcd").write_bytes(map_pcd(view_of(6), 1))
    cloud = open3d.io.read_point_cloud(str(tmp_path / "map.pcd"))
    points = points_of(view_of(6), 1)
    np.testing.assert_allclose(np.asarray(cloud.points)[:, 0], points["x"])
    red = np.asarray(cloud.colors)[points["state"] == MotionState.MOVING]
    np.testing.assert_allclose(red, np.broadcast_to(np.array([0xE0, 0x31, 0x2B]) / 255, red.shape), atol=1e-6)


def test_export_writes_the_same_bytes_every_time(tmp_path: Path) -> None:
    store = MapStore(tmp_path / "map.sqlite", "drive")
    for sequence, (frame, update) in enumerate(drive(30)):
        store.put(sequence, frame, update, NO_DENSITY)
    store.close()
    outs = [export_map(tmp_path / "map.sqlite", tmp_path / name, ("tum", "kitti", "pcd")) for name in ("a", "b")]
    assert [path.name for path in outs[0]] == ["trajectory.tum", "keyframes.tum", "trajectory.kitti", "map.pcd"]
    assert [path.read_bytes() for path in outs[0]] == [path.read_bytes() for path in outs[1]]
    view = view_of(30)
    assert (tmp_path / "a" / "map.pcd").read_bytes() == map_pcd(view, 1)
    assert (tmp_path / "a" / "trajectory.tum").read_text() == trajectory_tum(view, 1)
    assert not list(tmp_path.glob("*/*.part"))


def test_of_maps_that_were_never_joined_the_longest_is_exported(tmp_path: Path) -> None:
    store = MapStore(tmp_path / "map.sqlite", "drive")
    for sequence, (frame, update) in enumerate(drive(8)):
        map_id = 1 if sequence < 5 else 2
        keyframe_map_id = np.full(len(update.keyframe_id), map_id)
        store.put(sequence, replace(frame, map_id=map_id), replace(update, keyframe_map_id=keyframe_map_id), NO_DENSITY)
    store.close()
    (trajectory, _) = export_map(tmp_path / "map.sqlite", tmp_path, ["tum"])
    assert len(trajectory.read_text().splitlines()) == 1 + 5
    (trajectory, _) = export_map(tmp_path / "map.sqlite", tmp_path, ["tum"], map_id=2)
    assert len(trajectory.read_text().splitlines()) == 1 + 3


def test_a_format_nobody_knows_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="format 'xyz': expected one of tum, kitti, pcd"):
        export_map(tmp_path / "missing.sqlite", tmp_path / "out", ["tum", "xyz"])
    assert not (tmp_path / "out").exists()
