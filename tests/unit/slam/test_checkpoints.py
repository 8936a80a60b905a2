# SPDX-License-Identifier: Apache-2.0
"""A killed slam service goes on in the same map; in lossless, with the very same bytes."""

from pathlib import Path

import pytest

from schemas.records import TrackingState
from tests.unit.slam.slam_drive import SlamDrive
from tests.unit.slam.textured_room import TexturedRoom

FRAMES = 45


@pytest.fixture(scope="module")
def room() -> TexturedRoom:
    return TexturedRoom(seed=4)


@pytest.fixture(scope="module")
def undisturbed(room: TexturedRoom, tmp_path_factory: pytest.TempPathFactory) -> SlamDrive:
    drive = SlamDrive(room, state=tmp_path_factory.mktemp("state"), exact_checkpoint_keyframes=3)
    return drive.take(room.render(n)[0] for n in range(FRAMES)).finish()


def test_lossless_gives_the_same_bytes_however_often_it_falls(
    room: TexturedRoom, undisturbed: SlamDrive, tmp_path: Path
) -> None:
    drive = SlamDrive(room, state=tmp_path, exact_checkpoint_keyframes=3)
    for n in range(FRAMES):
        drive.take([room.render(n)[0]])
        if n % 4 == 1:
            drive.fall_and_rise()
    drive.finish()
    assert len(list(tmp_path.glob("engine-*.kmap"))) <= 2, "old checkpoints are deleted"
    assert drive.sent == undisturbed.sent


def test_there_were_checkpoints_to_fall_back_to(undisturbed: SlamDrive) -> None:
    state = undisturbed.service.snapshot()
    assert state["checkpoint"] > FRAMES // 2
    assert state["ended"] == 1


def test_a_frame_that_was_cut_off_in_the_journal_is_done_again(
    room: TexturedRoom, undisturbed: SlamDrive, tmp_path: Path
) -> None:
    drive = SlamDrive(room, state=tmp_path, exact_checkpoint_keyframes=3).take(room.render(n)[0] for n in range(20))
    (journal,) = tmp_path.glob(f"inputs-{drive.service.snapshot()['checkpoint']}.bin")
    with journal.open("ab") as file:
        file.write(b"half a frame")
    drive.fall_and_rise().take(room.render(n)[0] for n in range(20, FRAMES)).finish()
    assert drive.sent == undisturbed.sent


def test_realtime_finds_its_map_again_and_uses_no_id_twice(room: TexturedRoom, tmp_path: Path) -> None:
    drive = SlamDrive(room, state=tmp_path, mode="realtime", checkpoint_keyframes=3)
    drive.take(room.render(n)[0] for n in range(30))
    drive.service.close()
    before = drive.keyframes_by_map()[0]
    drive.fall_and_rise().take(room.render(n)[0] for n in range(24, 38))
    after = drive.tracked[30:]
    assert all(frame.state is TrackingState.TRACKING and frame.map_id == 0 for frame in after)
    first_update = set(drive.updates[30].keyframe_id.tolist())
    assert first_update <= before, "all that was mapped before is told again"
    new = {number for update in drive.updates[31:] for number in update.keyframe_id.tolist()} - before
    assert new
    assert min(new) >> 32 > max(before) >> 32


def test_without_checkpoints_a_killed_service_begins_another_map(room: TexturedRoom, tmp_path: Path) -> None:
    drive = SlamDrive(room, state=tmp_path, checkpoint_keyframes=0).take(room.render(n)[0] for n in range(12))
    drive.fall_and_rise().take(room.render(n)[0] for n in range(12, 24))
    assert (drive.tracked[11].map_id, drive.tracked[-1].map_id) == (0, 1)
    assert not list(tmp_path.iterdir())
