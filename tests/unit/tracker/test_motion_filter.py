# SPDX-License-Identifier: Apache-2.0
"""Whether an object moves, over its life."""

from hypothesis import given
from hypothesis import strategies as st

from schemas.records import MotionState
from services.tracker.motion_filter import MotionBelief, MotionFilterOptions, update_belief

OPTIONS = MotionFilterOptions()


def believe(*probabilities: float, belief: MotionBelief | None = None, age_frames: int = 0) -> MotionBelief:
    belief = belief or MotionBelief()
    for probability in probabilities:
        belief = update_belief(belief, probability, 20, age_frames, OPTIONS)
    return belief


def test_nothing_is_decided_before_there_is_evidence() -> None:
    assert believe().state is MotionState.UNDECIDED
    assert believe(0.5, 0.5, 0.5) == MotionBelief()
    assert update_belief(MotionBelief(), 0.99, 0, 0, OPTIONS) == MotionBelief()
    assert believe(0.6).state is MotionState.UNDECIDED


def test_evidence_decides() -> None:
    assert believe(0.95).state is MotionState.MOVING
    assert believe(0.2, 0.2).state is MotionState.NON_MOVING


def test_weak_evidence_adds_up() -> None:
    assert believe(*[0.65] * 6).state is MotionState.MOVING
    assert believe(*[0.35] * 6).state is MotionState.NON_MOVING


def test_a_car_that_stood_long_and_drives_off_is_found_within_three_frames() -> None:
    parked = believe(*[0.05] * 100)
    assert parked.state is MotionState.NON_MOVING
    assert believe(0.97, 0.97, 0.97, belief=parked).state is MotionState.MOVING


def test_one_wrong_frame_changes_nothing() -> None:
    parked = believe(*[0.1] * 20)
    assert believe(0.98, belief=parked).state is MotionState.NON_MOVING
    driving = believe(*[0.95] * 20)
    assert believe(0.02, belief=driving).state is MotionState.MOVING


def test_between_the_thresholds_the_state_stays() -> None:
    belief = believe(*[0.95] * 5)
    belief = update_belief(belief, 0.1, 20, 0, OPTIONS)
    belief = update_belief(belief, 0.3, 20, 0, OPTIONS)
    assert abs(belief.log_odds) < OPTIONS.decided_log_odds
    assert belief.state is MotionState.MOVING


def test_carried_masks_count_less() -> None:
    assert 0 < believe(0.9, age_frames=1).log_odds < believe(0.9).log_odds


@given(st.lists(st.floats(0.0, 1.0), max_size=40))
def test_the_belief_stays_bounded(probabilities: list[float]) -> None:
    belief = believe(*probabilities)
    assert abs(belief.log_odds) <= OPTIONS.largest_log_odds
    assert 0.0 < belief.moving_probability < 1.0
