# SPDX-License-Identifier: Apache-2.0
"""`kinemap thesis moseg` on a made-up folder of the data set's layout."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from services.formats.png import read_png, write_png


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """Two frames of testing, each with a car that moves on the left and one that stands on the right."""
    for name in ("images", "mask", "boxes"):
        (tmp_path / "moseg" / "testing" / name).mkdir(parents=True)
    (tmp_path / "predicted").mkdir()
    for number in range(2):
        name = f"2011_09_26_drive_0001_sync_{number:010d}"
        cars = np.zeros((40, 80), dtype=np.uint8)
        cars[10:20, 10:30] = cars[10:20, 50:70] = 255
        write_png(tmp_path / "moseg" / "testing" / "mask" / f"{name}.png", cars)
        (tmp_path / "moseg" / "testing" / "boxes" / f"{name}.txt").write_text("1 1 9 9 21 31\n2 0 9 49 21 71\n")
        # the left half of the mover is found, the standing car whole
        predicted = np.zeros((40, 80), dtype=np.uint8)
        predicted[10:20, 10:20], predicted[10:20, 50:70] = 2, 1
        write_png(tmp_path / "predicted" / f"{name}.png", predicted)
    return tmp_path / "moseg"


def test_masks_are_derived_and_predictions_scored(data: Path, kinemap: Any, tmp_path: Path) -> None:
    ended = kinemap("thesis", "moseg", "--data", data, "--predictions", "predicted", "--out", "out")
    assert ended.code == 0, ended.err
    found = json.loads((tmp_path / "out" / "moseg.json").read_text())
    assert found["derived"]["moving_boxes"] == 2
    assert found["derived"]["moving_share"] == 0.5
    iou = found["score"]["iou"]
    assert (iou["moving"], iou["non-moving"]) == (0.5, 1.0)
    assert iou["background"] == pytest.approx(2800 / 2900)
    assert found["score"]["mean_iou"] == pytest.approx((0.5 + 1.0 + 2800 / 2900) / 3)
    assert "| thesis, two-stream network | - | - | - | 0.350 |" in ended.out
    mask = read_png(tmp_path / "out" / "moving" / "2011_09_26_drive_0001_sync_0000000001.png", "a mask")
    assert sorted(np.unique(mask).tolist()) == [0, 1, 2]
    assert kinemap("thesis", "moseg", "--data", data, "--out", "out").code == 0  # the same again


def test_a_data_set_of_moving_masks_alone_is_pointed_at(data: Path, kinemap: Any) -> None:
    for file in (data / "testing" / "boxes").iterdir():
        file.write_text("1 1 9 9 21 31\n2 1 9 49 21 71\n")
    assert "those that stand belong too" in kinemap("thesis", "moseg", "--data", data, "--out", "out").out


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("--data", "nowhere"), ("--data nowhere: no such data set",)),
        (("--data", "moseg", "--split", "training"), ("--data moseg: no such data set",)),
        (("--data", "moseg", "--predictions", "none"), ("--predictions none: no such folder",)),
        (("--data", "moseg", "--predictions", "."), ("no masks, expected PNG files",)),
    ],
)
def test_bad_input_is_one_line(data: Path, kinemap: Any, arguments: tuple[str, ...], parts: tuple[str, ...]) -> None:
    kinemap("thesis", "moseg", *arguments, "--out", "out").is_one_line(*parts)


def test_masks_of_another_split_are_not_mixed_in(data: Path, kinemap: Any, tmp_path: Path) -> None:
    (tmp_path / "out" / "moving").mkdir(parents=True)
    write_png(tmp_path / "out" / "moving" / "other.png", np.zeros((2, 2), dtype=np.uint8))
    kinemap("thesis", "moseg", "--data", data, "--out", "out").is_one_line("other.png: not of this data set")
