# SPDX-License-Identifier: Apache-2.0
from itertools import pairwise

from services.segmenter.keyframes import AsOftenAsPossible, EveryNth

MS = 1_000_000


def _due(schedule: AsOftenAsPossible, frames: range, period_ms: int, takes_ms: int) -> list[int]:
    found = []
    for sequence in frames:
        if schedule.is_due(sequence, sequence * period_ms * MS):
            schedule.took(takes_ms * MS)
            found.append(sequence)
    return found


def test_every_nth_goes_by_the_number_alone() -> None:
    schedule = EveryNth(3)
    assert [sequence for sequence in (0, 1, 2, 3, 3, 6, 5, 9) if schedule.is_due(sequence, 0)] == [0, 3, 3, 6, 9]


def test_a_network_that_keeps_up_gets_every_frame() -> None:
    schedule = AsOftenAsPossible()
    assert _due(schedule, range(20), 100, 70) == list(range(20))
    assert schedule.every == 1


def test_a_slow_network_gets_as_many_frames_as_it_has_time_for() -> None:
    schedule = AsOftenAsPossible()
    due = _due(schedule, range(60), 100, 300)
    assert schedule.every == 4  # 300 ms of 0.8 x 400 ms
    assert set(_steps(due[3:])) == {4}


def test_the_interval_follows_the_camera_and_the_load() -> None:
    schedule = AsOftenAsPossible()
    _due(schedule, range(40), 100, 300)
    for sequence in range(40, 120):  # the camera slows down to 2 Hz
        if schedule.is_due(sequence, (4000 + (sequence - 40) * 500) * MS):
            schedule.took(300 * MS)
    assert schedule.every == 1
    for _ in range(50):
        schedule.took(100_000 * MS)
    assert schedule.every == 30


def test_frames_dropped_on_the_way_count() -> None:
    schedule = AsOftenAsPossible()
    for sequence in range(0, 80, 4):
        if schedule.is_due(sequence, sequence * 100 * MS):
            schedule.took(300 * MS)
    assert schedule.every == 4


def _steps(values: list[int]) -> list[int]:
    return [later - earlier for earlier, later in pairwise(values)]
