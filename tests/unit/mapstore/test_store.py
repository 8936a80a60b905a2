# SPDX-License-Identifier: Apache-2.0
"""The durable map: what was put is what is loaded, and what is no map is refused in one line."""

import re
import sqlite3
import subprocess
import sys
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from schemas.records import MapUpdate
from services.mapstore import map_file
from services.mapstore.density import DynamicDensity
from services.mapstore.export import load_view
from services.mapstore.landmark_cluster import LandmarkCluster
from services.mapstore.map_state import MapState
from services.mapstore.map_view import FrameColumns, MapView
from services.mapstore.store import MapStore
from services.runtime.errors import InputError, ResourceError
from tests.unit.mapstore.street_map import NO_DENSITY, drive, landmarks, state_of, tracked, waiting, with_keyframes

ROOT = Path(__file__).resolve().parents[3]


def filled(path: Path, frames: int) -> MapStore:
    store = MapStore(path, "drive")
    for sequence, (frame, update) in enumerate(drive(frames)):
        store.put(sequence, frame, update, NO_DENSITY)
    return store


def assert_same_map(left: MapView, right: MapView) -> None:
    for name in (field.name for field in fields(FrameColumns) if field.name != "reference_row"):
        np.testing.assert_array_equal(getattr(left.frames, name), getattr(right.frames, name))
    clusters = [
        {int(number): cluster for number, cluster in zip(view.keyframes.id, view.clusters, strict=True)}
        for view in (left, right)
    ]
    assert clusters[0].keys() == clusters[1].keys()
    for number, cluster in clusters[0].items():
        for name in (field.name for field in fields(LandmarkCluster)):
            np.testing.assert_array_equal(getattr(cluster, name), getattr(clusters[1][number], name))
    orders = [np.argsort(view.keyframes.id) for view in (left, right)]
    np.testing.assert_array_equal(left.keyframes.pose[orders[0]], right.keyframes.pose[orders[1]])
    np.testing.assert_array_equal(left.final_poses(), right.final_poses())
    assert left.sequence == right.sequence
    assert {k: v.tolist() for k, v in left.sightings.items()} == {k: v.tolist() for k, v in right.sightings.items()}


def test_what_was_put_is_what_is_loaded(tmp_path: Path) -> None:
    filled(tmp_path / "map.sqlite", 23).close()
    again = MapStore(tmp_path / "map.sqlite", "drive")
    assert again.last_sequence == 22
    assert_same_map(again.load().view(), state_of(23).view())
    again.close()


def test_a_map_is_continued_where_it_ends(tmp_path: Path) -> None:
    filled(tmp_path / "map.sqlite", 12).close()
    again = MapStore(tmp_path / "map.sqlite", "drive")
    for sequence, (frame, update) in enumerate(drive(23)):
        if sequence > again.last_sequence:
            again.put(sequence, frame, update, NO_DENSITY)
    again.close()
    assert_same_map(load_view(tmp_path / "map.sqlite"), state_of(23).view())


def test_a_frame_is_never_put_twice(tmp_path: Path) -> None:
    store = filled(tmp_path / "map.sqlite", 3)
    with pytest.raises(InputError, match="frame 2, expected one after 2"):
        store.put(2, tracked(2, 0), MapUpdate(0), NO_DENSITY)
    store.close()


def test_what_was_answered_is_kept(tmp_path: Path) -> None:
    store = MapStore(tmp_path / "map.sqlite", "drive")
    nowhere = replace(DynamicDensity().nowhere(state_of(1).view(), 10.0, float("inf")), timestamp_ns=0)
    store.put(0, tracked(0, 0), MapUpdate(0), NO_DENSITY)
    store.put(1, waiting(0), MapUpdate(0), nowhere)
    assert store.density_of(0) == NO_DENSITY
    assert repr(store.density_of(1)) == repr(nowhere)
    assert store.density_of(2) is None
    store.close()


def test_removed_landmarks_leave_a_tombstone_and_may_come_back(tmp_path: Path) -> None:
    store, ids = MapStore(tmp_path / "map.sqlite", "drive"), np.arange(3)
    points = with_keyframes(landmarks(0, 0, ids, np.ones((3, 3))), 0)
    store.put(0, tracked(0, 0), points, NO_DENSITY)
    store.put(1, tracked(1, 0), MapUpdate(1, removed_landmark_id=np.array([0, 2, 99])), NO_DENSITY)
    assert store.load().view().counts_by_state().sum() == 1
    store.put(2, tracked(2, 0), landmarks(2, 0, np.array([2]), np.ones(3)), NO_DENSITY)
    assert store.load().view().counts_by_state().sum() == 2
    store.close()
    with sqlite3.connect(tmp_path / "map.sqlite") as connection:
        assert connection.execute("SELECT * FROM removed_landmarks ORDER BY id").fetchall() == [(0, 1), (99, 1)]


def test_what_changed_after_the_last_frame_is_in_the_map(tmp_path: Path) -> None:
    store = filled(tmp_path / "map.sqlite", 6)
    store.put_last_update(6, with_keyframes(MapUpdate(0), 0, y=3.0))
    store.checkpoint()
    store.close()
    assert not (tmp_path / "map.sqlite-wal").exists()
    view = load_view(tmp_path / "map.sqlite")
    assert view.sequence == 6
    np.testing.assert_allclose(view.final_poses()[0, :3], [0.0, 3.0, 0.0])


def test_a_closed_map_is_one_file_that_reading_adds_nothing_to(tmp_path: Path) -> None:
    filled(tmp_path / "map.sqlite", 3).close()
    load_view(tmp_path / "map.sqlite")
    assert [path.name for path in tmp_path.iterdir()] == ["map.sqlite"]


def test_a_map_that_is_read_can_be_closed_and_opened_again(tmp_path: Path) -> None:
    store = filled(tmp_path / "map.sqlite", 3)
    reader = map_file.open_to_read(tmp_path / "map.sqlite")
    reader.execute("BEGIN")
    assert reader.execute("SELECT count(*) FROM frames").fetchone() == (3,)
    store.close()
    again = MapStore(tmp_path / "map.sqlite", "drive")
    again.put(3, tracked(3, 0), MapUpdate(3), NO_DENSITY)
    assert reader.execute("SELECT count(*) FROM frames").fetchone() == (3,)
    reader.close()
    again.close()
    assert load_view(tmp_path / "map.sqlite").sequence == 3


def test_readers_see_whole_frames_while_the_store_writes(tmp_path: Path) -> None:
    store = filled(tmp_path / "map.sqlite", 6)
    assert load_view(tmp_path / "map.sqlite").sequence == 5
    store.put(6, tracked(6, 5), MapUpdate(6), NO_DENSITY)
    assert load_view(tmp_path / "map.sqlite").sequence == 6
    store.close()


def test_a_map_of_another_session_is_refused(tmp_path: Path) -> None:
    filled(tmp_path / "map.sqlite", 1).close()
    with pytest.raises(InputError, match="holds the map of session 'drive', expected 'other' or a new file"):
        MapStore(tmp_path / "map.sqlite", "other")


def test_a_map_of_a_newer_version_is_refused(tmp_path: Path) -> None:
    filled(tmp_path / "map.sqlite", 1).close()
    with sqlite3.connect(tmp_path / "map.sqlite") as connection:
        connection.execute(f"PRAGMA user_version = {map_file.SCHEMA_VERSION + 6}")
    for opening in (lambda path: MapStore(path, "drive"), load_view):
        with pytest.raises(
            InputError, match=r"map\.sqlite: map version 8, expected at most 2; a newer kinemap wrote it"
        ):
            opening(tmp_path / "map.sqlite")


def test_an_sqlite_file_of_another_program_is_refused_and_untouched(tmp_path: Path) -> None:
    with sqlite3.connect(tmp_path / "other.sqlite") as connection:
        connection.execute("CREATE TABLE songs (title TEXT)")
    before = (tmp_path / "other.sqlite").read_bytes()
    with pytest.raises(InputError, match="an SQLite file, but no kinemap map"):
        MapStore(tmp_path / "other.sqlite", "drive")
    assert (tmp_path / "other.sqlite").read_bytes() == before


def test_a_file_that_is_no_database_is_refused_and_untouched(tmp_path: Path) -> None:
    (tmp_path / "map.sqlite").write_text("not a map, and longer than a header " * 40)
    with pytest.raises(InputError, match=r"map\.sqlite: no kinemap map, or a damaged one"):
        MapStore(tmp_path / "map.sqlite", "drive")
    assert (tmp_path / "map.sqlite").read_text().startswith("not a map")


def test_a_map_that_is_not_there_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"missing\.sqlite: no such file; expected a kinemap map"):
        load_view(tmp_path / "missing.sqlite")


def test_a_folder_in_the_way_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "map.sqlite").mkdir()
    with pytest.raises(ResourceError, match=r"map\.sqlite: cannot be opened"):
        MapStore(tmp_path / "map.sqlite", "drive")


def test_a_full_disk_is_one_error_and_leaves_the_frames_before_readable(tmp_path: Path) -> None:
    store = filled(tmp_path / "map.sqlite", 11)
    pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
    store._connection.execute(f"PRAGMA max_page_count = {pages}")
    many = landmarks(11, 10, 5_000_000 + np.arange(20_000), np.ones((20_000, 3)))
    with pytest.raises(ResourceError, match=r"the disk is full or failing .*; frames up to 10 stay readable"):
        store.put(11, tracked(11, 10), many, NO_DENSITY)
    assert_same_map(load_view(tmp_path / "map.sqlite"), state_of(11).view())
    store.close()
    assert_same_map(load_view(tmp_path / "map.sqlite"), state_of(11).view())


def test_numbers_that_are_none_stay_out_of_the_map_after_loading_too(tmp_path: Path) -> None:
    store = MapStore(tmp_path / "map.sqlite", "drive")
    update = with_keyframes(landmarks(0, 0, np.arange(3), [[0, 0, 1], [np.nan, 0, 1], [0, 0, np.inf]]), 0, 5)
    update.keyframe_pose[1] = np.nan
    store.put(0, tracked(0, 0), update, NO_DENSITY)
    view = store.load().view()
    assert view.counts_by_state().sum() == 1
    assert np.isfinite(view.keyframes.pose).all(axis=1).tolist() == [True, False]
    assert DynamicDensity().at(view, np.array([1.0, 0.0, 0.0]), 5.0, 30.0).observed_points == 1
    store.close()


def test_a_map_in_a_folder_nobody_may_write_to_can_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    filled(tmp_path / "map.sqlite", 4).close()
    monkeypatch.setattr(map_file.os, "access", lambda *_: False)
    assert load_view(tmp_path / "map.sqlite").sequence == 3


FILLING = """
import resource, signal, sys
from pathlib import Path
from services.mapstore.store import MapStore
from services.runtime.errors import ResourceError
from tests.unit.mapstore.street_map import NO_DENSITY, drive
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
store = MapStore(Path(sys.argv[1]), "drive")
resource.setrlimit(resource.RLIMIT_FSIZE, (600_000, 600_000))
try:
    for sequence, (frame, update) in enumerate(drive(2000, points=400, every=1)):
        store.put(sequence, frame, update, NO_DENSITY)
except ResourceError as error:
    print(error)
"""


@pytest.mark.real_processes
def test_when_the_disk_takes_no_more_what_is_on_it_stays_readable(tmp_path: Path) -> None:
    command = [sys.executable, "-c", FILLING, str(tmp_path / "map.sqlite")]
    said = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=120, check=True).stdout
    (sequence,) = re.findall(r"the disk is full or failing .*; frames up to (\d+) stay readable\n$", said)
    view = load_view(tmp_path / "map.sqlite")
    assert view.sequence == int(sequence) > 0
    assert view.counts_by_state().sum() == 400 * (view.sequence + 1)


def test_an_empty_map_can_be_read(tmp_path: Path) -> None:
    MapStore(tmp_path / "map.sqlite", "drive").close()
    view = load_view(tmp_path / "map.sqlite")
    assert_same_map(view, MapState().view())
