# SPDX-License-Identifier: Apache-2.0
import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from services.formats.label_images import (
    LabelledInstance,
    read_label_image,
    read_label_index,
    write_label_image,
    write_label_index,
)
from services.runtime.errors import InputError


@pytest.mark.parametrize(("highest", "bits"), [(255, np.uint8), (256, np.uint16), (65535, np.uint16)])
def test_labels_come_back_in_as_few_bits_as_they_need(tmp_path: Path, highest: int, bits: type) -> None:
    labels = np.array([[0, 1], [7, highest]], dtype=np.uint32)
    write_label_image(tmp_path / "a.png", labels)
    assert cv2.imread(str(tmp_path / "a.png"), cv2.IMREAD_UNCHANGED).dtype == bits
    np.testing.assert_array_equal(read_label_image(tmp_path / "a.png"), labels)


@pytest.mark.parametrize("label", [-1, 65536])
def test_labels_that_do_not_fit_are_refused(tmp_path: Path, label: int) -> None:
    with pytest.raises(InputError, match=f"label {label}, expected 0..65535"):
        write_label_image(tmp_path / "a.png", np.array([[label]]))


def test_index_comes_back(tmp_path: Path) -> None:
    index = {"000000": (LabelledInstance(1, "car", 0.5, True), LabelledInstance(3, "person")), "000001": ()}
    write_label_index(tmp_path, index)
    assert read_label_index(tmp_path) == index


@pytest.mark.parametrize(
    ("index", "said"),
    [
        ([], "a list"),
        ({"7": {}}, "frame 7: {}, expected a list"),
        ({"7": [{"id": 0, "category": "car"}]}, "frame 7"),
        ({"7": [{"id": 1, "category": "car", "score": 2}]}, "frame 7"),
        ({"7": [{"id": 1, "category": "car", "score": True}]}, "frame 7"),
        ({"7": [{"id": 1, "category": "car", "moving": 1}]}, "frame 7"),
        ({"7": [{"id": 1, "category": "car"}, {"id": 1, "category": "car"}]}, "twice"),
    ],
)
def test_wrong_rows_are_named(tmp_path: Path, index: object, said: str) -> None:
    (tmp_path / "instances.json").write_text(json.dumps(index))
    with pytest.raises(InputError, match=r"instances\.json") as error:
        read_label_index(tmp_path)
    assert said in str(error.value)


def test_a_folder_without_index_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"instances\.json: no such file"):
        read_label_index(tmp_path)
    with pytest.raises(InputError, match="no such folder"):
        read_label_index(tmp_path / "none")


def test_a_colour_picture_is_no_label_image(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.zeros((4, 4, 3), dtype=np.uint8))
    with pytest.raises(InputError, match=r"a\.png.*expected one channel"):
        read_label_image(tmp_path / "a.png")


def test_real_folder_is_read(shared_data: Path) -> None:
    folder = shared_data / "kitti_traffic" / "instances"
    index = read_label_index(folder)
    assert len(index) == 78
    frame, instances = next(iter(index.items()))
    present = set(np.unique(read_label_image(folder / f"{frame}.png")).tolist())
    assert {item.label for item in instances} <= present
