# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest

from services.evaluation.moving_masks.flag import LabelledFlagEvaluator
from services.evaluation.moving_masks.inputs import MovingMaskFolder, paired_frames, read_pairs
from services.evaluation.moving_masks.iou import MaskClass, compare_masks, sum_of
from services.formats.label_images import LabelledInstance, write_label_image, write_label_index
from services.runtime.errors import InputError

BACKGROUND, NON_MOVING, MOVING = MaskClass
TRUTH = np.array([[0, 0, 0, 0], [1, 1, 1, 1], [2, 2, 2, 2]], dtype=np.uint8)
FOUND = np.array([[0, 0, 0, 1], [1, 1, 2, 2], [2, 2, 0, 0]], dtype=np.uint8)


def test_iou_by_hand() -> None:
    score = compare_masks("0", TRUTH, FOUND)
    assert score.iou(BACKGROUND) == pytest.approx(3 / 6)
    assert score.iou(NON_MOVING) == pytest.approx(2 / 5)
    assert score.iou(MOVING) == pytest.approx(2 / 6)
    assert score.mean_iou == pytest.approx((3 / 6 + 2 / 5 + 2 / 6) / 3)
    assert (score.precision, score.recall) == (0.5, 0.5)


def test_a_data_set_is_summed_before_it_is_divided() -> None:
    nothing = np.zeros((3, 4), dtype=np.uint8)
    scores = [compare_masks("0", TRUTH, FOUND), compare_masks("1", nothing, nothing), compare_masks("2", TRUTH, TRUTH)]
    total = sum_of(scores)
    assert total.iou(MOVING) == pytest.approx((2 + 4) / (6 + 4))
    assert scores[1].iou(MOVING) is None
    assert scores[1].mean_iou == 1.0
    assert sum_of([]).mean_iou is None


def test_of_two_classes_only_moving_counts() -> None:
    score = sum_of([compare_masks("0", TRUTH, FOUND)], binary=True)
    assert score.iou(MOVING) == pytest.approx(2 / 6)
    assert score.iou(BACKGROUND) == pytest.approx(6 / 10)
    assert score.mean_iou == pytest.approx((2 / 6 + 6 / 10) / 2)
    assert score.confusion.sum() == TRUTH.size


def _masks(path: Path, masks: dict[str, np.ndarray]) -> Path:
    path.mkdir()
    for name, mask in masks.items():
        write_label_image(path / f"{name}.png", mask)
    return path


def _score(found: Path, truth: Path) -> tuple[float | None, bool]:
    folders = MovingMaskFolder(truth), MovingMaskFolder(found)
    frames, _ = paired_frames(*folders)
    scores = [compare_masks(frame, t.mask, f.mask) for frame, t, f in read_pairs(*folders, frames)]
    binary = any(folder.is_binary for folder in folders)
    return sum_of(scores, binary=binary).iou(MOVING), binary


def test_masks_of_davis_are_binary_and_meet_those_of_three_classes(tmp_path: Path) -> None:
    davis = np.where(TRUTH == 2, 255, 0).astype(np.uint8)
    three, two = _masks(tmp_path / "three", {"0": FOUND}), _masks(tmp_path / "two", {"0": davis})
    assert _score(three, two) == (pytest.approx(2 / 6), True)
    assert _score(three, three) == (1.0, False)


def test_a_frame_that_was_not_found_is_all_background(tmp_path: Path) -> None:
    truth = _masks(tmp_path / "truth", {"0": TRUTH, "1": TRUTH})
    found = _masks(tmp_path / "found", {"0": TRUTH, "7": TRUTH})
    assert paired_frames(MovingMaskFolder(truth), MovingMaskFolder(found)) == (["0", "1"], ("1",))
    assert _score(found, truth)[0] == pytest.approx(4 / 8)


@pytest.mark.parametrize(
    ("masks", "said"),
    [
        ({"9": TRUTH}, "no frame of the truth's, expected names such as '0'; found '9'"),
        ({"0": TRUTH[:2]}, "mask of frame 0: 4x2 px, expected 4x3"),
        ({"0": TRUTH + 1}, r"0\.png: pixels of 1, 2, 3, expected 0 \(background\)"),
        ({"0": np.where(TRUTH == 2, 255, TRUTH)}, r"0\.png: pixels of 0, 1, 255"),
        ({}, "no masks, expected PNG files"),
    ],
)
def test_nonsense_is_one_clear_line(tmp_path: Path, masks: dict[str, np.ndarray], said: str) -> None:
    truth = _masks(tmp_path / "truth", {"0": TRUTH})
    with pytest.raises(InputError, match=said):
        _score(_masks(tmp_path / "found", masks), truth)


def test_label_images_become_masks_by_their_flags(tmp_path: Path) -> None:
    folder = _masks(tmp_path / "labels", {"0": np.array([[0, 5], [6, 6]])})
    rows = [LabelledInstance(5, "car", moving=True), LabelledInstance(6, "car", moving=False)]
    write_label_index(folder, {"0": rows})
    assert MovingMaskFolder(folder).read("0").mask.tolist() == [[0, 2], [1, 1]]
    write_label_index(folder, {"0": [LabelledInstance(5, "car")]})
    with pytest.raises(InputError, match="frame 0: instance 5 does not say whether it moves"):
        MovingMaskFolder(folder)


def test_the_flag_of_instances_by_hand() -> None:
    labels = np.zeros((60, 200), dtype=np.uint16)
    for number, height in enumerate((50, 50, 50, 50, 20), start=1):
        labels[:height, 40 * (number - 1) : 40 * number - 10] = number
    truth = [LabelledInstance(n, "car", moving=n in (1, 2, 5)) for n in range(1, 6)]
    found_labels = np.where(labels > 0, labels + 10, 0).astype(np.uint16)
    found_labels[found_labels == 12] = 0  # the second was missed
    found_labels[0:50, 70:80] = 30  # and something moves where nothing is
    found = [LabelledInstance(n + 10, "car", moving=n in (1, 3)) for n in (1, 3, 4, 5)]
    evaluator = LabelledFlagEvaluator(0.5, 40.0)
    evaluator.add((labels, truth), (found_labels, [*found, LabelledInstance(30, "car", moving=True)]))
    score = evaluator.score
    assert (score.true_positives, score.false_positives, score.false_negatives, score.true_negatives) == (1, 2, 1, 1)
    assert (score.missed, score.unfounded) == (1, 1)
