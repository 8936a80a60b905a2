# SPDX-License-Identifier: Apache-2.0
"""Semi-dense maps: kept in the file beside the sparse one, and exported with its labels."""

import sqlite3
from dataclasses import replace
from pathlib import Path

import numpy as np

from schemas.records import MapUpdate, MotionState
from services.mapstore import map_file
from services.mapstore.dense_table import read_clouds
from services.mapstore.export import export_map, load_view
from services.mapstore.export.dense_pcd import DENSE_POINT
from services.mapstore.store import MapStore
from tests.unit.mapstore.street_map import (
    FRAME_NS,
    NO_DENSITY,
    PARKED_CAR,
    PASSING_CAR,
    drive,
    keyframe_id,
    landmarks,
    tracked,
    with_keyframes,
)


def with_clouds(update: MapUpdate, *clouds: tuple[int, int]) -> MapUpdate:
    """The update with (keyframe, points) clouds: straight ahead, one metre further each, on background and two cars."""
    counts = [count for _, count in clouds]
    position = np.concatenate([np.stack([np.zeros(n), np.zeros(n), np.arange(1, n + 1)], axis=1) for n in counts])
    number = np.resize(np.array([0, PARKED_CAR, PASSING_CAR], np.uint32), len(position))
    states = {0: MotionState.STATIC, PARKED_CAR: MotionState.NON_MOVING, PASSING_CAR: MotionState.MOVING}
    return replace(
        update,
        dense_keyframe_id=np.array([keyframe_id(frame) for frame, _ in clouds]),
        dense_keyframe_points=np.array(counts, np.int32),
        dense_point_position=position.astype(np.float32),
        dense_point_depth_sigma=np.full(len(position), 0.25, np.float32),
        dense_point_grey=np.full(len(position), 255, np.uint8),
        dense_point_state=np.array([states[one] for one in number.tolist()], np.uint8),
        dense_point_category=np.where(number > 0, 3, -1).astype(np.int16),
        dense_point_object_id=number,
    )


def store_drive(path: Path, *updates: MapUpdate) -> Path:
    store = MapStore(path, "drive")
    for sequence, update in enumerate(updates):
        store.put(sequence, tracked(sequence, 0), update, NO_DENSITY)
    store.close()
    return path


def read_dense(path: Path) -> np.ndarray:
    header, data = path.read_bytes().split(b"DATA binary\n", 1)
    assert b"FIELDS x y z rgb state category object_id grey sigma t_s\nSIZE 4 4 4 4 1 4 4 1 4 8\n" in header
    return np.frombuffer(data, DENSE_POINT)


def nothing() -> MapUpdate:
    return MapUpdate(timestamp_ns=0, map_id=1, metric_scale=True)


def test_a_later_cloud_replaces_the_earlier_one_of_its_keyframe(tmp_path: Path) -> None:
    first = with_clouds(with_keyframes(nothing(), 0, 5), (0, 4), (5, 3))
    path = store_drive(tmp_path / "map.sqlite", first, with_clouds(nothing(), (0, 2)))
    assert load_view(path).dense_points == 5
    connection = map_file.open_to_read(path)
    clouds = list(read_clouds(connection))
    connection.close()
    assert [(cloud.keyframe_id, len(cloud.grey)) for cloud in clouds] == [(keyframe_id(0), 2), (keyframe_id(5), 3)]
    np.testing.assert_array_equal(clouds[1].position, first.dense_point_position[4:])
    np.testing.assert_array_equal(clouds[1].object_id, first.dense_point_object_id[4:])


def test_export_places_points_by_the_newest_pose_of_their_keyframe(tmp_path: Path) -> None:
    first = with_clouds(with_keyframes(nothing(), 0, 5), (5, 3))
    moved = with_keyframes(nothing(), 5, scale=2.0, y=10.0, culled=1)
    path = store_drive(tmp_path / "map.sqlite", first, moved)
    *_, file = export_map(path, tmp_path, ["pcd"])
    assert file.name == "map_dense.pcd"
    points = read_dense(file)
    np.testing.assert_allclose(points["x"], [7, 9, 11], rtol=1e-6)
    np.testing.assert_allclose(points["y"], 10, rtol=1e-6)
    np.testing.assert_allclose(points["sigma"], 0.5)
    np.testing.assert_allclose(points["t_s"], 5 * FRAME_NS * 1e-9)
    assert points["state"].tolist() == [0, 1, 2]
    assert points["rgb"].tolist() == [0x2E9E44, 0xF2C500, 0xE0312B]
    assert points["category"].tolist() == [-1, 3, 3]
    assert points["object_id"].tolist() == [0, PARKED_CAR, PASSING_CAR]


def test_export_leaves_out_what_stood_and_drove_off_after_it_was_seen(tmp_path: Path) -> None:
    seen = with_clouds(with_keyframes(nothing(), 0, 5), (0, 3), (5, 3))
    parked = landmarks(0, 0, np.array([1]), np.ones((1, 3)), state=1, object_id=PARKED_CAR, valid_until_ns=2 * FRAME_NS)
    path = store_drive(tmp_path / "map.sqlite", with_clouds(with_keyframes(parked, 0, 5), (0, 3), (5, 3)))
    *_, file = export_map(path, tmp_path, ["pcd"])
    points = read_dense(file)
    assert len(points) == len(seen.dense_point_grey) - 1
    assert points["t_s"][points["object_id"] == PARKED_CAR].tolist() == [5 * FRAME_NS * 1e-9]


def test_a_map_of_version_1_opens_and_takes_clouds(tmp_path: Path) -> None:
    path = store_drive(tmp_path / "map.sqlite", *(update for _, update in drive(3)))
    connection = sqlite3.connect(path)
    connection.executescript("DROP TABLE dense_keyframes; PRAGMA user_version = 1;")
    connection.close()
    assert load_view(path).dense_points == 0
    store = MapStore(path, "drive")
    store.put(3, tracked(3, 0), with_clouds(nothing(), (0, 3)), NO_DENSITY)
    assert store.load().view().dense_points == 3
    store.close()
