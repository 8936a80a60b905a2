# SPDX-License-Identifier: Apache-2.0
"""A camera that is lost gets a new map in the end; the old one is kept, and gone on with where it is recognised."""

import numpy as np
import pytest

from schemas.records import TrackingState
from tests.unit.slam.slam_drive import SlamDrive
from tests.unit.slam.textured_room import TexturedRoom


@pytest.fixture(scope="module")
def kidnapped() -> SlamDrive:
    """Twelve frames of one room, darkness, twelve of another, darkness, and the first room again."""
    before, after = TexturedRoom(seed=1), TexturedRoom(seed=2)
    black = np.zeros((before.height, before.width), dtype=np.uint8)
    first = [before.render(n)[0] for n in range(12)]
    second = [after.render(n)[0] for n in range(12)]
    drive = SlamDrive(before, new_map_after_lost=4)
    return drive.take([*first, *[black] * 6, *second, *[black] * 6, *first])


def test_after_darkness_elsewhere_a_second_map_begins(kidnapped: SlamDrive) -> None:
    tracked = kidnapped.tracked
    assert TrackingState.LOST in [one.state for one in tracked[12:18]]
    assert (tracked[11].map_id, tracked[29].map_id) == (0, 1)
    assert tracked[11].state is tracked[29].state is TrackingState.TRACKING
    keyframes = kidnapped.keyframes_by_map()
    assert {0, 1} <= set(keyframes)
    assert not keyframes[0] & keyframes[1]


def test_back_in_the_first_room_the_first_map_goes_on(kidnapped: SlamDrive) -> None:
    tracked = kidnapped.tracked
    found = tracked[36:]
    assert all(one.state is TrackingState.TRACKING and one.map_id == 0 for one in found[2:])
    for one, then in zip(found[6:], tracked[6:12], strict=True):
        assert one.map_from_camera is not None
        assert then.map_from_camera is not None
        np.testing.assert_allclose(one.map_from_camera[:3], then.map_from_camera[:3], atol=0.02)


def test_a_lost_frame_says_how_long_it_has_been_and_what_it_waits_for(kidnapped: SlamDrive) -> None:
    tracked = kidnapped.tracked
    assert tracked[13].reason == "lost: no keyframe recognised; frame 2 of 4 before a new map"
    assert tracked[16].state is TrackingState.INITIALIZING
    assert tracked[16].reason.endswith("not recognised in 1 earlier map(s)")
