# SPDX-License-Identifier: Apache-2.0
"""The credits of `lossless`: held against a plain model with random histories, and by example."""

from itertools import pairwise

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from services.runtime.frame_window import FrameWindow

SERVICES = ("slam", "mapstore", "recorder")


def test_frame_n_waits_for_the_answers_to_n_minus_w() -> None:
    window = FrameWindow(3, SERVICES, 2.0)
    for sequence in range(3):
        assert window.may_send
        window.sent(sequence, 0.0)
    assert not window.may_send
    for service in ("slam", "recorder"):
        assert window.answered(service, 0)
    assert not window.may_send
    assert window.missing(0) == {"mapstore"}
    assert window.answered("mapstore", 0)
    assert (window.done, window.may_send) == (0, True)


def test_a_later_frame_answered_first_frees_nothing() -> None:
    window = FrameWindow(2, SERVICES, 2.0)
    window.sent(0, 0.0)
    window.sent(1, 0.0)
    for service in SERVICES:
        window.answered(service, 1)
    assert (window.done, window.may_send, window.in_flight) == (-1, False, (0,))
    for service in SERVICES:
        window.answered(service, 0)
    assert (window.done, window.may_send, window.in_flight) == (1, True, ())


def test_a_camera_that_resumes_starts_behind_what_is_done() -> None:
    window = FrameWindow(2, SERVICES, 2.0, first=40)
    assert (window.done, window.next_sequence) == (39, 40)
    window.sent(40, 0.0)
    assert not window.answered("slam", 39)


def test_overdue_frames_are_given_once_and_ever_less_often() -> None:
    window = FrameWindow(4, SERVICES, 2.0)
    window.sent(0, 10.0)
    window.sent(1, 11.0)
    assert window.next_due_s() == 12.0
    assert window.overdue(11.9) == ()
    assert window.overdue(12.0) == (0,)
    assert window.overdue(12.0) == ()
    assert window.overdue(13.0) == (1,)
    times = [now / 10 for now in range(130, 2000) if 0 in window.overdue(now / 10)]
    gaps = [round(later - earlier, 1) for earlier, later in pairwise(times)]
    assert times[0] == 16.0
    assert gaps[0] == 8.0
    assert set(gaps[1:]) == {16.0}


def test_a_service_that_came_back_gets_all_at_once() -> None:
    window = FrameWindow(4, SERVICES, 2.0)
    for sequence in range(3):
        window.sent(sequence, 0.0)
    for service in SERVICES:
        window.answered(service, 1)
    window.overdue(5.0)
    window.expire(6.0)
    assert window.overdue(6.0) == (0, 2)
    assert window.overdue(8.0) == (0, 2)


def test_what_is_answered_is_never_overdue() -> None:
    window = FrameWindow(4, SERVICES, 2.0)
    window.sent(0, 0.0)
    for service in SERVICES:
        window.answered(service, 0)
    assert window.overdue(100.0) == ()
    assert window.next_due_s() is None


@pytest.mark.parametrize(
    ("window", "services", "wait_s"),
    [(0, SERVICES, 1.0), (1, (), 1.0), (1, SERVICES, 0.0), (1, SERVICES, float("nan"))],
)
def test_bad_arguments(window: int, services: tuple[str, ...], wait_s: float) -> None:
    with pytest.raises(ValueError, match="expected a window of at least 1, a positive time and at least one service"):
        FrameWindow(window, services, wait_s)


def test_sending_out_of_turn_is_refused() -> None:
    window = FrameWindow(1, SERVICES, 1.0)
    with pytest.raises(ValueError, match="frame 1 sent, expected 0"):
        window.sent(1, 0.0)
    window.sent(0, 0.0)
    with pytest.raises(ValueError, match="with 1 in flight"):
        window.sent(1, 0.0)


class AgainstModel(RuleBasedStateMachine):
    """Random answers, repeated, early and unknown ones among them, against sets of pairs."""

    WINDOW = 4

    def __init__(self) -> None:
        super().__init__()
        self.window = FrameWindow(self.WINDOW, SERVICES, 1.0)
        self.sent = 0
        self.answers: set[tuple[str, int]] = set()

    def _complete(self, sequence: int) -> bool:
        return all((service, sequence) in self.answers for service in SERVICES)

    @precondition(lambda self: self.window.may_send)
    @rule()
    def send(self) -> None:
        self.window.sent(self.sent, 0.0)
        self.sent += 1

    @rule(service=st.sampled_from((*SERVICES, "stranger")), back=st.integers(-2, WINDOW + 2))
    def answer(self, service: str, back: int) -> None:
        sequence = self.sent - back
        known = service in SERVICES and 0 <= sequence < self.sent
        news = known and (service, sequence) not in self.answers
        assert self.window.answered(service, sequence) == news
        if known:
            self.answers.add((service, sequence))

    @invariant()
    def agrees(self) -> None:
        open_frames = [sequence for sequence in range(self.sent) if not self._complete(sequence)]
        done = open_frames[0] - 1 if open_frames else self.sent - 1
        assert self.window.done == done
        assert list(self.window.in_flight) == open_frames
        assert self.window.may_send == (self.sent <= done + self.WINDOW)
        assert len(self.window.in_flight) <= self.WINDOW


TestAgainstModel = AgainstModel.TestCase
TestAgainstModel.settings = settings(max_examples=60, stateful_step_count=40, deadline=None)
