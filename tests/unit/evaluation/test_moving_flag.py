# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from schemas.records import MotionState, Objects, ObjectTrack, TrueInstances, TrueObject
from services.evaluation.run.moving_flag import MovingFlagEvaluator, MovingFlagScore, mask_iou
from services.runtime.errors import InputError

HEIGHT, WIDTH = 120, 200


def _truth(*objects: tuple[int, float, float], time_ns: int = 0) -> TrueInstances:
    """Objects of (id, speed m/s, height px), side by side, 30 px wide."""
    labels = np.zeros((HEIGHT, WIDTH), dtype=np.uint32)
    rows = []
    for slot, (instance_id, speed, height) in enumerate(objects):
        labels[: int(height), slot * 40 : slot * 40 + 30] = instance_id
        box = (slot * 40.0, 0.0, 30.0, float(height))
        rows.append(TrueObject(instance_id, "car", speed >= 0.1, (speed, 0.0, 0.0), (0.0, 0.0, 0.0), box))
    return TrueInstances(time_ns, labels, tuple(rows))


def _estimate(truth: TrueInstances, states: dict[int, MotionState], offset: int = 100) -> Objects:
    """The true masks under other ids, as a perfect tracker would give them; objects without a state are missing."""
    image = np.zeros_like(truth.labels)
    rows = []
    for true_object in truth.objects:
        if true_object.instance_id in states:
            object_id = true_object.instance_id + offset
            image[truth.labels == true_object.instance_id] = object_id
            state = states[true_object.instance_id]
            rows.append(ObjectTrack(object_id, "car", 0.9, state, 0.5, true_object.box_px, 3))
    return Objects(truth.timestamp_ns, image, tuple(rows))


def _score(truth: TrueInstances, states: dict[int, MotionState]) -> MovingFlagScore:
    evaluator = MovingFlagEvaluator()
    evaluator.add(truth, _estimate(truth, states))
    return evaluator.score


MOVING, STANDING, UNDECIDED = MotionState.MOVING, MotionState.NON_MOVING, MotionState.UNDECIDED
TRAFFIC = _truth((1, 8.0, 60), (2, 3.0, 60), (3, 0.0, 60), (4, 0.0, 60))


def test_a_right_estimate_scores_one() -> None:
    score = _score(TRAFFIC, {1: MOVING, 2: MOVING, 3: STANDING, 4: UNDECIDED})
    assert (score.precision, score.recall, score.f1) == (1.0, 1.0, 1.0)
    assert score.true_negatives == 2


def test_always_no_fails() -> None:
    score = _score(TRAFFIC, dict.fromkeys((1, 2, 3, 4), STANDING))
    assert score.precision is None
    assert score.recall == 0.0
    assert score.f1 == 0.0


def test_always_yes_fails_on_precision() -> None:
    score = _score(TRAFFIC, dict.fromkeys((1, 2, 3, 4), MOVING))
    assert score.precision == 0.5
    assert score.recall == 1.0


def test_undecided_is_not_moving() -> None:
    assert _score(TRAFFIC, {1: UNDECIDED, 2: MOVING, 3: STANDING}).recall == 0.5


def test_an_object_that_is_missing_counts_against_recall() -> None:
    score = _score(TRAFFIC, {1: MOVING, 3: STANDING})
    assert (score.recall, score.missed) == (0.5, 1)


@pytest.mark.parametrize("ignored", [(9, 5.0, 39), (9, 0.0, 39), (9, 0.5, 60)])
@pytest.mark.parametrize("state", [MOVING, STANDING])
def test_small_and_slow_objects_count_for_nothing(ignored: tuple[int, float, float], state: MotionState) -> None:
    score = _score(_truth(ignored), {9: state})
    assert (score.true_positives, score.false_positives, score.false_negatives, score.true_negatives) == (0, 0, 0, 0)


def test_motion_where_nothing_is_counts_against_precision() -> None:
    truth = _truth((1, 8.0, 60))
    estimate = _estimate(_truth((1, 8.0, 60), (2, 8.0, 60), (3, 8.0, 30)), dict.fromkeys((1, 2, 3), MOVING))
    evaluator = MovingFlagEvaluator()
    evaluator.add(truth, estimate)
    assert (evaluator.score.precision, evaluator.score.unfounded) == (0.5, 1)


def test_a_mask_that_lies_mostly_elsewhere_is_not_the_object() -> None:
    truth = _truth((1, 8.0, 60))
    estimate = _estimate(truth, {1: MOVING})
    estimate.track_image[:] = np.roll(estimate.track_image, 12, axis=1)
    evaluator = MovingFlagEvaluator()
    evaluator.add(truth, estimate)
    assert (evaluator.score.recall, evaluator.score.precision) == (0.0, 0.0)


def test_frames_add_up() -> None:
    evaluator = MovingFlagEvaluator()
    for time_ns, state in enumerate((UNDECIDED, MOVING, MOVING, MOVING)):
        truth = _truth((1, 8.0, 60), time_ns=time_ns)
        evaluator.add(truth, _estimate(truth, {1: state}))
    assert (evaluator.score.frames, evaluator.score.recall) == (4, 0.75)


def test_another_time_or_size_is_refused() -> None:
    truth = _truth((1, 8.0, 60))
    with pytest.raises(InputError, match="objects of 7 ns, expected those of the truth's 0 ns"):
        MovingFlagEvaluator().add(truth, _estimate(_truth((1, 8.0, 60), time_ns=7), {}))
    with pytest.raises(InputError, match=r"track image of \(2, 2\), expected \(120, 200\)"):
        MovingFlagEvaluator().add(truth, Objects(0, np.zeros((2, 2), dtype=np.uint32), ()))


@settings(deadline=None, max_examples=60)
@given(data=st.data(), seed=st.integers(0, 2**31))
def test_mask_iou_against_brute_force(data: st.DataObject, seed: int) -> None:
    rng = np.random.default_rng(seed)
    ids = data.draw(st.lists(st.integers(1, 2**32 - 1), min_size=1, max_size=4, unique=True))
    first, second = (rng.choice(np.array([0, *ids], dtype=np.uint32), size=(7, 9)) for _ in range(2))
    expected = np.zeros((len(ids), len(ids)))
    for row, first_id in enumerate(ids):
        for column, second_id in enumerate(ids):
            a, b = first == first_id, second == second_id
            expected[row, column] = (a & b).sum() / max((a | b).sum(), 1)
    np.testing.assert_allclose(mask_iou(first, ids, second, ids), expected)
