# SPDX-License-Identifier: Apache-2.0
"""A map that is saved is found again: to be localised in, to be gone on with, or to be refused in one line."""

from pathlib import Path

import numpy as np
import pytest

from schemas.records import TrackingState
from services.runtime.errors import InputError, ResourceError
from tests.unit.slam.slam_drive import SlamDrive
from tests.unit.slam.textured_room import TexturedRoom


@pytest.fixture(scope="module")
def room() -> TexturedRoom:
    return TexturedRoom(seed=1)


@pytest.fixture(scope="module")
def first(room: TexturedRoom, tmp_path_factory: pytest.TempPathFactory) -> tuple[SlamDrive, Path]:
    """Twelve frames, and the map they left."""
    path = tmp_path_factory.mktemp("maps") / "room.kmap"
    drive = SlamDrive(room, save_map=path)
    return drive.take(room.render(n)[0] for n in range(12)).finish(), path


def test_a_camera_is_localised_in_a_loaded_map_that_stays_as_it_is(
    room: TexturedRoom, first: tuple[SlamDrive, Path]
) -> None:
    before, path = first
    bytes_before = path.read_bytes()
    drive = SlamDrive(room, map_file=path, localize_only=True)
    drive.take(room.render(n)[0] for n in range(3, 12)).finish()
    assert all(frame.state is TrackingState.TRACKING for frame in drive.tracked)
    for frame, then in zip(drive.tracked, before.tracked[3:], strict=True):
        assert frame.map_from_camera is not None
        assert then.map_from_camera is not None
        np.testing.assert_allclose(frame.map_from_camera[:3], then.map_from_camera[:3], atol=0.03)
    assert drive.keyframes_by_map() == before.keyframes_by_map()
    assert all(len(update.landmark_id) == 0 for update in drive.updates[1:])
    assert path.read_bytes() == bytes_before


def test_where_a_loaded_map_is_not_recognised_localising_makes_no_map(
    room: TexturedRoom, first: tuple[SlamDrive, Path]
) -> None:
    elsewhere = TexturedRoom(seed=9)
    drive = SlamDrive(room, map_file=first[1], localize_only=True, new_map_after_lost=3)
    drive.take(elsewhere.render(n)[0] for n in range(8)).finish()
    assert {frame.state for frame in drive.tracked} == {TrackingState.LOST}
    assert drive.tracked[-1].reason == "lost: not recognised in 1 loaded map(s)"
    assert set(drive.keyframes_by_map()) == {0}


def test_a_loaded_map_is_gone_on_with_in_its_own_frame_of_reference(
    room: TexturedRoom, first: tuple[SlamDrive, Path], tmp_path: Path
) -> None:
    before, path = first
    longer = tmp_path / "longer.kmap"
    drive = SlamDrive(room, map_file=path, save_map=longer)
    drive.take(room.render(n)[0] for n in range(6, 40)).finish()
    assert all(frame.state is TrackingState.TRACKING and frame.map_id == 0 for frame in drive.tracked)
    old, new = before.keyframes_by_map()[0], drive.keyframes_by_map()[0]
    assert old < new
    step = np.diff(
        [frame.map_from_camera[:3] for frame in before.tracked[3:] if frame.map_from_camera is not None], axis=0
    )
    expected_x = np.linalg.norm(step, axis=1).mean() * 39
    last = drive.tracked[-1].map_from_camera
    assert last is not None
    assert last[0] == pytest.approx(expected_x, rel=0.1)
    assert longer.stat().st_size > path.stat().st_size


def test_a_camera_elsewhere_gets_a_second_map_after_a_while(room: TexturedRoom, first: tuple[SlamDrive, Path]) -> None:
    elsewhere = TexturedRoom(seed=9)
    drive = SlamDrive(room, map_file=first[1], new_map_after_lost=3)
    drive.take(elsewhere.render(n)[0] for n in range(12))
    assert [frame.state for frame in drive.tracked[:3]] == [TrackingState.LOST] * 3
    assert drive.tracked[1].reason == "lost: not recognised in 1 loaded map(s); frame 2 of 3 before a new map"
    assert drive.tracked[-1].state is TrackingState.TRACKING
    assert drive.tracked[-1].map_id == 1


@pytest.mark.parametrize(
    ("damage", "expected"),
    [
        (lambda data: b"", "is empty"),
        (lambda data: data[: len(data) // 2], "is cut off"),
        (lambda data: data[:1000] + bytes([data[1000] ^ 1]) + data[1001:], "is damaged: its checksum does not fit"),
        (lambda data: data[:8] + b"\x07" + data[9:], "is of version 7, expected 2"),
        (lambda data: b"PNG" + data, "is not a kinemap map file"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_in_one_line(
    room: TexturedRoom, first: tuple[SlamDrive, Path], tmp_path: Path, damage: object, expected: str
) -> None:
    assert callable(damage)
    path = tmp_path / "bad.kmap"
    path.write_bytes(damage(first[1].read_bytes()))
    drive = SlamDrive(room, map_file=path)
    with pytest.raises(InputError) as refused:
        drive.take([room.render(0)[0]])
    assert str(refused.value).startswith(f"map file {path}: {expected}")
    assert "\n" not in str(refused.value)


def test_another_camera_is_refused(first: tuple[SlamDrive, Path]) -> None:
    larger = TexturedRoom(seed=1, width=640)
    with pytest.raises(InputError, match="was made with another camera or pyramid"):
        SlamDrive(larger, map_file=first[1]).take([larger.render(0)[0]])


def test_a_place_that_cannot_be_written_to_is_named(room: TexturedRoom, tmp_path: Path) -> None:
    drive = SlamDrive(room, save_map=tmp_path / "nowhere" / "room.kmap").take([room.render(0)[0]])
    with pytest.raises(ResourceError, match=r"map file .*nowhere"):
        drive.finish()
