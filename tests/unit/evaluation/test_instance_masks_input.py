# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

import numpy as np
import pytest

from services.evaluation.instance_masks.average_precision import mask_precision
from services.evaluation.instance_masks.inputs import read_mask_input
from services.formats.coco import CocoAnnotation, CocoCategory, CocoDataset, CocoImage, write_coco
from services.formats.label_images import LabelledInstance, write_label_image, write_label_index
from services.formats.rle import encode_mask
from services.runtime.errors import InputError


def _folder(path: Path, frames: dict[str, list[tuple[int, str, float]]], shape: tuple[int, int] = (40, 80)) -> Path:
    """A folder of label images; instance i is a box of 20x20 px at x = 25 * (i - 1)."""
    path.mkdir()
    for name, rows in frames.items():
        labels = np.zeros(shape, dtype=np.uint16)
        for label, _, _ in rows:
            labels[5:25, 25 * (label - 1) : 25 * (label - 1) + 20] = label
        write_label_image(path / f"{name}.png", labels)
    write_label_index(path, {name: [LabelledInstance(*row) for row in rows] for name, rows in frames.items()})
    return path


TRUTH = {"000": [(1, "car", 1.0), (2, "robot", 1.0)], "001": [(1, "car", 1.0)], "002": []}


def test_folders_are_matched_by_frame_and_category(tmp_path: Path) -> None:
    truth = _folder(tmp_path / "truth", TRUTH)
    found = _folder(tmp_path / "found", {"000": [(1, "car", 0.9), (2, "car", 0.8)], "009": [(1, "car", 0.7)]})
    given = read_mask_input(found, truth)
    assert given.without_result == ("001", "002")
    assert given.without_truth == 1
    assert given.category_ids(["car"]) == [3]
    assert given.category_ids() == [3, 1000]
    assert [(r.image_id, r.category_id, r.score) for r in given.found] == [(1, 3, 0.9), (1, 3, 0.8)]
    score = mask_precision(given.truth, given.found, given.category_ids())
    assert score.by_category["car"].ap == pytest.approx(51 / 101)  # one of two found, precision 1 up to recall 0.5
    assert score.by_category["robot"].ap == 0.0


def test_a_folder_against_itself_is_perfect(tmp_path: Path) -> None:
    truth = _folder(tmp_path / "truth", TRUTH)
    given = read_mask_input(truth, truth)
    assert mask_precision(given.truth, given.found, given.category_ids()).mean.ap == pytest.approx(1.0)


def test_annotations_serve_as_results_by_file_name(tmp_path: Path) -> None:
    mask = np.zeros((40, 80), dtype=bool)
    mask[5:25, 5:25] = True
    for name, image_id, category_id in (("truth", 7, 3), ("found", 1, 1)):
        annotation = CocoAnnotation.of_mask(1, image_id, category_id, encode_mask(mask))
        images, categories = (CocoImage(image_id, "a.png", 80, 40),), (CocoCategory(category_id, "car"),)
        write_coco(tmp_path / f"{name}.json", CocoDataset(images, categories, (annotation,)))
    given = read_mask_input(tmp_path / "found.json", tmp_path / "truth.json")
    assert mask_precision(given.truth, given.found, [3]).mean.ap == pytest.approx(1.0)


def test_nonsense_is_one_clear_line(tmp_path: Path) -> None:
    truth = _folder(tmp_path / "truth", TRUTH)
    (tmp_path / "found.json").write_text("[]")
    cases = {
        _folder(tmp_path / "other", {"x": [(1, "car", 1.0)]}): "no frame of the truth's, expected names such as '000'",
        _folder(tmp_path / "size", {"000": [(1, "car", 1.0)]}, (30, 40)): "40x30 px, expected 80x40",
        tmp_path / "found.json": "expected two of a kind",
        tmp_path / "none": "no such file or folder",
    }
    for found, said in cases.items():
        with pytest.raises(InputError) as error:
            read_mask_input(found, truth)
        assert said in str(error.value)
        assert "\n" not in str(error.value)
    with pytest.raises(InputError, match="'horse': not in the truth, expected one of car, robot"):
        read_mask_input(truth, truth).category_ids(["horse"])


def test_a_true_mask_without_a_pixel_is_refused(tmp_path: Path) -> None:
    truth = _folder(tmp_path / "truth", TRUTH)
    write_label_image(truth / "001.png", np.zeros((40, 80), dtype=np.uint8))
    with pytest.raises(InputError, match="instance 1 of 001 has an empty mask"):
        read_mask_input(truth, truth)
