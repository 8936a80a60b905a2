# SPDX-License-Identifier: Apache-2.0
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pycocotools.coco import COCO

from services.formats.coco import (
    CocoAnnotation,
    CocoCategory,
    CocoDataset,
    CocoImage,
    CocoResult,
    read_coco,
    read_coco_results,
    write_coco,
    write_coco_results,
)
from services.formats.rle import encode_mask
from services.runtime.errors import InputError


def _mask(top: int, left: int) -> np.ndarray:
    mask = np.zeros((24, 32), dtype=bool)
    mask[top : top + 8, left : left + 6] = True
    return mask


@pytest.fixture
def dataset() -> CocoDataset:
    return CocoDataset(
        images=(CocoImage(1, "000000.png", 32, 24), CocoImage(2, "000001.png", 32, 24)),
        categories=(CocoCategory(3, "car", "vehicle"),),
        annotations=(
            CocoAnnotation.of_mask(1, 1, 3, encode_mask(_mask(2, 3)), {"track_id": 7, "moving": True}),
            CocoAnnotation.of_mask(2, 2, 3, encode_mask(_mask(4, 9))),
        ),
        info={"description": "two cars"},
    )


def test_annotations_come_back(dataset: CocoDataset, tmp_path: Path) -> None:
    write_coco(tmp_path / "a.json", dataset)
    assert read_coco(tmp_path / "a.json") == dataset
    assert dataset.annotations[0].area_px == 48.0
    assert dataset.annotations[0].box_px == (3.0, 2.0, 6.0, 8.0)


@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")  # pycocotools' own, with numpy 2
def test_pycocotools_reads_what_is_written(dataset: CocoDataset, tmp_path: Path) -> None:
    write_coco(tmp_path / "a.json", dataset)
    write_coco_results(tmp_path / "r.json", [CocoResult(1, 3, encode_mask(_mask(2, 3)), 0.5)])
    truth = COCO(str(tmp_path / "a.json"))
    np.testing.assert_array_equal(truth.annToMask(truth.loadAnns([1])[0]), _mask(2, 3))
    results = truth.loadRes(str(tmp_path / "r.json"))
    assert results.loadAnns([1])[0]["score"] == 0.5


def test_results_come_back(dataset: CocoDataset, tmp_path: Path) -> None:
    results = (CocoResult(1, 3, encode_mask(_mask(2, 4)), 0.25), CocoResult(2, 3, encode_mask(_mask(4, 9)), 1.0))
    write_coco_results(tmp_path / "r.json", results)
    assert read_coco_results(tmp_path / "r.json", dataset) == results


def test_polygons_of_the_official_files_are_read(tmp_path: Path) -> None:
    content = {
        "images": [{"id": 5, "file_name": "x.jpg", "width": 32, "height": 24, "license": 1}],
        "categories": [{"id": 1, "name": "person"}],
        "annotations": [
            {
                "id": 9, "image_id": 5, "category_id": 1, "iscrowd": 0, "area": 40.5, "bbox": [1, 1, 8, 6],
                "segmentation": [[1, 1, 9, 1, 9, 7, 1, 7]],
            }
        ],
    }  # fmt: skip
    (tmp_path / "a.json").write_text(json.dumps(content))
    annotation = read_coco(tmp_path / "a.json").annotations[0]
    assert (annotation.area_px, annotation.box_px, annotation.is_crowd) == (40.5, (1.0, 1.0, 8.0, 6.0), False)


def _content(dataset: CocoDataset, tmp_path: Path) -> dict[str, Any]:
    write_coco(tmp_path / "whole.json", dataset)
    content: dict[str, Any] = json.loads((tmp_path / "whole.json").read_text())
    return content


@pytest.mark.parametrize(
    ("where", "key", "value", "said"),
    [
        ("images", "width", 0, r"images\[0\].*width and height"),
        ("images", "id", "one", r"images\[0\]"),
        ("images", "id", 2, "twice"),
        ("categories", "name", 4, r"categories\[0\]"),
        ("annotations", "image_id", 77, r"annotations\[0\]: image_id 77"),
        ("annotations", "category_id", 1, r"annotations\[0\]: category_id 1, expected one of 3"),
        ("annotations", "segmentation", {"size": [24, 32], "counts": "zz"}, r"annotations\[0\]: a mask that"),
        ("annotations", "segmentation", {"size": [32, 24], "counts": "zz"}, "24x32 px, expected 32x24"),
        ("annotations", "bbox", [1, 2], r"bbox \[1, 2\]"),
        ("annotations", "area", -3, "area -3"),
        ("annotations", "id", None, "id null"),
    ],
)
def test_wrong_annotations_are_named(
    *, dataset: CocoDataset, tmp_path: Path, where: str, key: str, value: object, said: str
) -> None:
    content = _content(dataset, tmp_path)
    content[where][0][key] = value
    (tmp_path / "a.json").write_text(json.dumps(content))
    with pytest.raises(InputError, match=said) as error:
        read_coco(tmp_path / "a.json")
    assert "a.json" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("text", ["[]", "{}", '{"images": 3}', "{", "\xff"])
def test_a_file_that_is_no_data_set_is_named(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.json").write_text(text, encoding="latin-1")
    with pytest.raises(InputError, match=r"a\.json.*expected"):
        read_coco(tmp_path / "a.json")


@pytest.mark.parametrize(
    ("row", "said"),
    [
        (3, "result 0: 3"),
        ({"image_id": 9, "category_id": 3}, "image_id 9"),
        ({"image_id": 1, "category_id": 4}, "category_id 4"),
        ({"image_id": 1, "category_id": 3, "score": 1.5}, "score 1.5"),
        ({"image_id": 1, "category_id": 3, "score": float("nan")}, "score NaN"),
        ({"image_id": 1, "category_id": 3, "score": 0.5, "bbox": [0, 0, 1, 1]}, "no mask"),
    ],
)
def test_wrong_results_are_named(dataset: CocoDataset, tmp_path: Path, row: object, said: str) -> None:
    (tmp_path / "r.json").write_text(json.dumps([row]))
    with pytest.raises(InputError, match=said):
        read_coco_results(tmp_path / "r.json", dataset)


@pytest.mark.parametrize(
    ("place", "change", "expected"),
    [
        ("annotations", {"area": float("nan")}, "area NaN, expected square pixels"),
        ("annotations", {"area": 10**400}, "expected square pixels"),
        ("annotations", {"bbox": [float("nan")] * 4}, "expected x, y, width, height"),
        ("annotations", {"bbox": [10**400, 1, 1, 1]}, "expected x, y, width, height"),
        ("annotations", {"iscrowd": "no"}, 'iscrowd "no", expected 0 or 1'),
        ("annotations", {"attributes": [1]}, "attributes .1., expected an object"),
        ("annotations", {"segmentation": [[-1e9, -1e9, 1e9, -1e9, 1e9, 1e9]]}, "polygons of 3 points and more"),
        ("categories", {"id": 4, "name": "car"}, "stands twice under categories"),
        ("categories", {"id": 3, "name": "bus"}, "stands twice under categories"),
    ],
)
def test_what_would_be_counted_wrong_is_refused(
    tmp_path: Path, place: str, change: dict[str, object], expected: str
) -> None:
    annotation = {"id": 1, "image_id": 1, "category_id": 3, "segmentation": [[1, 1, 9, 1, 9, 9]]}
    content = {
        "images": [{"id": 1, "file_name": "a.png", "width": 20, "height": 10}],
        "categories": [{"id": 3, "name": "car"}] + ([change] if place == "categories" else []),
        "annotations": [annotation | (change if place == "annotations" else {})],
    }
    (tmp_path / "truth.json").write_text(json.dumps(content))
    with pytest.raises(InputError, match=expected):
        read_coco(tmp_path / "truth.json")
