# SPDX-License-Identifier: Apache-2.0
import sys
import warnings
from collections.abc import Sequence

import numpy as np
import pytest

from services.evaluation.object_tracking.metrics import MatchedFrame, ObjectTrackingEvaluator, TrackingScore
from services.runtime.errors import ResourceError

pytest.importorskip("trackeval", reason="extra tracking-evaluation is not installed")


def _frame(true: Sequence[int], found: Sequence[int], pairs: dict[tuple[int, int], float]) -> MatchedFrame:
    iou = np.zeros((len(true), len(found)))
    for (true_id, found_id), value in pairs.items():
        iou[true.index(true_id), found.index(found_id)] = value
    return MatchedFrame(np.array(true, dtype=np.int64), np.array(found, dtype=np.int64), iou)


def _score(*sequences: Sequence[MatchedFrame]) -> TrackingScore:
    evaluator = ObjectTrackingEvaluator()
    return evaluator.combined([evaluator.sequence(frames) for frames in sequences])


def test_a_perfect_tracker_scores_one() -> None:
    score = _score([_frame([1, 2], [7, 9], {(1, 7): 1.0, (2, 9): 1.0})] * 5)
    assert (score.hota, score.det_a, score.ass_a, score.loc_a) == (1.0, 1.0, 1.0, 1.0)
    assert (score.mota, score.motp, score.idf1) == (1.0, 1.0, 1.0)
    assert (score.id_switches, score.false_positives, score.false_negatives) == (0, 0, 0)
    assert (score.mostly_tracked, score.true_objects, score.true_detections) == (2, 2, 10)


def test_a_switch_of_id_by_hand() -> None:
    """One object in 4 frames, called 7 in two of them and 8 in the other two, always exactly where it is."""
    frames = [_frame([1], [found], {(1, found): 1.0}) for found in (7, 7, 8, 8)]
    score = _score(frames)
    assert score.id_switches == 1
    assert score.mota == pytest.approx(1 - 1 / 4)
    assert score.idf1 == pytest.approx(2 * 2 / (2 * 2 + 2 + 2))
    # each of the four matches: 2 frames shared of the 4 that either id has
    assert score.ass_a == pytest.approx(2 / 4)
    assert score.det_a == 1.0
    assert score.hota == pytest.approx(np.sqrt(0.5))


def test_misses_and_false_alarms_by_hand() -> None:
    """Two objects in 3 frames: one is missed once, one thing is invented."""
    frames = [
        _frame([1, 2], [7, 8], {(1, 7): 1.0, (2, 8): 1.0}),
        _frame([1, 2], [7], {(1, 7): 1.0}),
        _frame([1, 2], [7, 8, 9], {(1, 7): 1.0, (2, 8): 1.0}),
    ]
    score = _score(frames)
    assert (score.false_positives, score.false_negatives, score.id_switches) == (1, 1, 0)
    assert score.mota == pytest.approx(1 - 2 / 6)
    assert score.idf1 == pytest.approx(2 * 5 / (2 * 5 + 1 + 1))
    assert score.det_a == pytest.approx(5 / 7)
    assert score.ass_a == pytest.approx((3 * 1.0 + 2 * (2 / 3)) / 5)
    assert score.hota == pytest.approx(np.sqrt(score.det_a * score.ass_a))
    assert score.fragmentations == 1


def test_masks_that_half_fit_lower_hota_at_the_strict_end() -> None:
    score = _score([_frame([1], [7], {(1, 7): 0.72})] * 4)
    assert (score.mota, score.motp) == (1.0, pytest.approx(0.72))
    assert score.hota_by_iou == (1.0,) * 14 + (0.0,) * 5  # 0.05 to 0.70, 0.75 to 0.95
    assert score.hota == pytest.approx(14 / 19)


def test_frames_without_truth_count_what_was_found_there() -> None:
    score = _score([_frame([], [7], {}), _frame([1], [7], {(1, 7): 1.0}), _frame([], [], {}), _frame([1], [], {})])
    assert (score.false_positives, score.false_negatives) == (1, 1)
    assert score.mota == pytest.approx(0.0)


def test_nothing_found_and_nothing_there() -> None:
    assert _score([_frame([1], [], {})] * 3).hota == 0.0
    assert _score([_frame([1], [], {})] * 3).false_negatives == 3
    assert _score([_frame([], [4], {})] * 3).false_positives == 3
    assert _score([]).true_detections == 0


def test_sequences_are_summed() -> None:
    good = [_frame([1], [7], {(1, 7): 1.0})] * 3
    bad = [_frame([1], [], {})]
    score = _score(good, bad)
    assert score.mota == pytest.approx(3 / 4)
    assert (score.true_objects, score.true_detections) == (2, 4)


def test_ids_may_be_any_numbers() -> None:
    score = _score([_frame([10**12, 5], [-3, 2], {(10**12, -3): 1.0, (5, 2): 1.0})] * 2)
    assert score.hota == 1.0


def test_nothing_is_printed_and_nothing_warned(capsys: pytest.CaptureFixture[str]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        _score([_frame([1], [7], {(1, 7): 0.9})] * 2)
    assert capsys.readouterr() == ("", "")


def test_without_trackeval_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "trackeval", None)
    with pytest.raises(ResourceError, match="pip install") as error:
        ObjectTrackingEvaluator()
    assert "\n" not in str(error.value)
