# SPDX-License-Identifier: Apache-2.0
"""KITTI's semantic-instance truth, and the score of segmenters against it, on made-up masks."""

from pathlib import Path

import numpy as np
import pytest

from schemas.categories import category_id
from services.evaluation.thesis.instances import describe_instances, gain_percent, instances_table, score_segmenter
from services.formats.coco import CocoImage, CocoResult
from services.formats.kitti_semantic import annotations, read_instances, semantic_frames
from services.formats.png import write_png
from services.formats.rle import decode_mask, encode_mask
from services.runtime.errors import InputError

IMAGE = CocoImage(1, "000000_10", 60, 40)
CAR = category_id("car")


def _truth() -> np.ndarray:
    labels = np.full((40, 60), 7 * 256, dtype=np.uint16)  # road
    labels[10:20, 5:25] = 26 * 256 + 1
    labels[10:30, 30:50] = 26 * 256 + 2
    labels[0:5, 0:5] = 26 * 256  # cars that nobody took apart
    labels[30:38, 2:8] = 24 * 256 + 1  # a person
    return labels


def _data_set(folder: Path) -> Path:
    for name in ("image_2", "instance"):
        (folder / "training" / name).mkdir(parents=True)
    write_png(folder / "training" / "image_2" / "000000_10.png", np.zeros((40, 60), dtype=np.uint8))
    write_png(folder / "training" / "instance" / "000000_10.png", _truth())
    return folder


def _result(mask: np.ndarray, score: float = 0.9) -> CocoResult:
    return CocoResult(1, CAR, encode_mask(mask), score)


def test_cars_are_class_26_and_those_without_instance_are_a_crowd(tmp_path: Path) -> None:
    frame = semantic_frames(_data_set(tmp_path))[0]
    found = annotations(read_instances(frame), IMAGE, "car", 5)
    assert [item.annotation_id for item in found] == [5, 6, 7]
    assert [item.is_crowd for item in found] == [True, False, False]
    assert decode_mask(found[1].mask).sum() == 200
    assert {item.category_id for item in found} == {CAR}


def test_the_training_folder_itself_will_do(tmp_path: Path) -> None:
    assert semantic_frames(_data_set(tmp_path) / "training") == semantic_frames(tmp_path)


@pytest.mark.parametrize(
    "lost", ["training/instance", "training/instance/000000_10.png", "training/image_2/000000_10.png"]
)
def test_another_layout_is_refused_in_one_line(tmp_path: Path, lost: str) -> None:
    folder = _data_set(tmp_path)
    path = folder / lost
    if path.is_dir():
        path.rename(folder / "elsewhere")
    else:
        path.unlink()
    with pytest.raises(InputError, match="expected") as raised:
        semantic_frames(folder)
    assert "\n" not in str(raised.value)


def test_a_truth_of_8_bits_is_refused(tmp_path: Path) -> None:
    folder = _data_set(tmp_path)
    write_png(folder / "training" / "instance" / "000000_10.png", np.zeros((40, 60), dtype=np.uint8))
    with pytest.raises(InputError, match="expected one channel of 16 bits"):
        read_instances(semantic_frames(folder)[0])


def test_both_averages_and_the_gain_on_the_first() -> None:
    labels = _truth()
    truth = annotations(labels, IMAGE, "car", 1)
    whole = [_result(labels == 26 * 256 + number) for number in (1, 2)]
    part = labels == 26 * 256 + 2
    part[:, 43:] = False  # 13 of 20 columns: IoU 0.65
    crowd = _result(labels == 26 * 256)
    good = score_segmenter("good", [IMAGE], truth, [*whole, crowd], "car", seconds=2.0)
    poor = score_segmenter("poor", [IMAGE], truth, [whole[0], _result(part, 0.8)], "car", seconds=None)
    assert good.precision.ap_thesis == pytest.approx(1.0)
    assert good.precision.true_instances == 2
    # found up to IoU 0.6 (seven thresholds), half of both (51 of 101 recalls) at the four above
    assert poor.precision.ap_thesis == pytest.approx((7 * 1.0 + 4 * 51 / 101) / 11)
    assert poor.precision.ap == pytest.approx((4 * 1.0 + 6 * 51 / 101) / 10)
    gain = gain_percent(good, poor)
    assert gain == pytest.approx(100.0 * (1.0 / ((7 + 4 * 51 / 101) / 11) - 1.0))
    table = instances_table([poor, good], "car")
    assert table.rows[0][2] == "-"
    assert table.rows[1][2] == f"{gain:+.2f}"
    assert table.rows[1][-2:] == ("2.00", "2.000")
    assert table.rows[-1][0] == "thesis, SOLOv2"
    assert table.rows[-1][-2] == "67.25"
    assert describe_instances([poor, good], "car", 0.3)["segmenters"][1]["gain_percent"] == gain


def test_images_without_a_car_have_no_score() -> None:
    with pytest.raises(InputError, match="without a true instance of car"):
        score_segmenter("none", [IMAGE], [], [], "car", seconds=None)
