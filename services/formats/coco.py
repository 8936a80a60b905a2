# SPDX-License-Identifier: Apache-2.0
"""COCO's JSON of instances: annotations (the truth) and results (what a network found), masks as RLE.

Source: https://cocodataset.org/#format-data and #format-results.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from services.formats.json_file import read_json, shortened, write_json
from services.formats.rle import Rle, mask_area, mask_box, rle_from_coco
from services.runtime.errors import InputError

_ANNOTATIONS = "COCO's annotations: an object with images, annotations and categories"
_RESULTS = "COCO's results: a list of {image_id, category_id, segmentation, score}"
_LARGEST_SIDE_PX = 65535
_LARGEST_MEASURE = float(_LARGEST_SIDE_PX**2)


@dataclass(frozen=True)
class CocoImage:
    """One image; `width` and `height` in pixels."""

    image_id: int
    file_name: str
    width: int
    height: int


@dataclass(frozen=True)
class CocoCategory:
    """One category; the 80 official ids are in schemas.categories."""

    category_id: int
    name: str
    supercategory: str = ""


@dataclass(frozen=True)
class CocoAnnotation:
    """One true instance. `area_px` and `box_px` (x, y, width, height) are those of the mask unless the file says other.

    `is_crowd`: a region of many, in which nothing found is wrong. `attributes` is free: other programs keep or skip it.
    """

    annotation_id: int
    image_id: int
    category_id: int
    mask: Rle
    area_px: float
    box_px: tuple[float, float, float, float]
    is_crowd: bool = False
    attributes: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of_mask(
        cls, annotation_id: int, image_id: int, category_id: int, mask: Rle, attributes: Mapping[str, Any] | None = None
    ) -> "CocoAnnotation":
        """One that is no crowd, its area and box those of the mask."""
        area, box = float(mask_area(mask)), mask_box(mask)
        return cls(annotation_id, image_id, category_id, mask, area, box, attributes=attributes or {})


@dataclass(frozen=True)
class CocoDataset:
    """A file of annotations."""

    images: tuple[CocoImage, ...]
    categories: tuple[CocoCategory, ...]
    annotations: tuple[CocoAnnotation, ...]
    info: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class CocoResult:
    """One instance that was found; `score` in 0..1."""

    image_id: int
    category_id: int
    mask: Rle
    score: float


def read_coco(path: Path) -> CocoDataset:
    """Read annotations.

    Raises:
        InputError: no such file, or not as COCO says; names file, list, position, what was found and expected.
    """
    content = read_json(path, _ANNOTATIONS)
    if not isinstance(content, dict):
        raise InputError(f"{path}: a {type(content).__name__}, expected {_ANNOTATIONS}")
    images = tuple(_image(place, row) for place, row in _rows(path, content, "images"))
    categories = tuple(_category(place, row) for place, row in _rows(path, content, "categories"))
    image_by_id = {image.image_id: image for image in images}
    known_categories = {category.category_id for category in categories}
    if len(image_by_id) != len(images):
        raise InputError(f"{path}: an id stands twice under images, expected each once")
    if not len(categories) == len(known_categories) == len({category.name for category in categories}):
        raise InputError(f"{path}: an id or a name stands twice under categories, expected each once")
    annotations = []
    for place, row in _rows(path, content, "annotations"):
        image, category_id = _checked_ids(place, row, image_by_id, known_categories)
        annotations.append(_annotation(place, row, image, category_id))
    return CocoDataset(images, categories, tuple(annotations), _mapping(str(path), "info", content.get("info")))


def write_coco(path: Path, dataset: CocoDataset) -> None:
    """Write annotations that every reader of COCO takes; RLE also where COCO itself has polygons."""
    annotations = [
        {
            "id": item.annotation_id,
            "image_id": item.image_id,
            "category_id": item.category_id,
            "segmentation": item.mask.as_coco(),
            "area": item.area_px,
            "bbox": list(item.box_px),
            "iscrowd": int(item.is_crowd),
            **({"attributes": dict(item.attributes)} if item.attributes else {}),
        }
        for item in dataset.annotations
    ]
    content = {
        "info": dict(dataset.info),
        "images": [
            {"id": image.image_id, "file_name": image.file_name, "width": image.width, "height": image.height}
            for image in dataset.images
        ],
        "categories": [
            {"id": category.category_id, "name": category.name, "supercategory": category.supercategory}
            for category in dataset.categories
        ],
        "annotations": annotations,
    }
    write_json(path, content)


def read_coco_results(path: Path, dataset: CocoDataset) -> tuple[CocoResult, ...]:
    """Read results that were found on the images of `dataset`.

    Raises:
        InputError: as for `read_coco`; also for an image, category or mask size that the data set does not have.
    """
    rows = read_json(path, _RESULTS)
    if not isinstance(rows, list):
        raise InputError(f"{path}: a {type(rows).__name__}, expected {_RESULTS}")
    image_by_id = {image.image_id: image for image in dataset.images}
    known_categories = {category.category_id for category in dataset.categories}
    results = []
    for number, row in enumerate(rows):
        place = f"{path} result {number}"
        image, category_id = _checked_ids(place, row, image_by_id, known_categories)
        score = row.get("score")
        if not isinstance(score, int | float) or isinstance(score, bool) or not 0.0 <= score <= 1.0:
            raise InputError(f"{place}: score {shortened(score)}, expected a number in 0..1")
        results.append(CocoResult(image.image_id, category_id, _mask(place, row, image), float(score)))
    return tuple(results)


def write_coco_results(path: Path, results: Iterable[CocoResult]) -> None:
    """Write results as COCO's evaluation takes them."""
    rows = [
        {
            "image_id": result.image_id,
            "category_id": result.category_id,
            "segmentation": result.mask.as_coco(),
            "score": result.score,
        }
        for result in results
    ]
    write_json(path, rows)


def _rows(path: Path, content: dict[str, Any], name: str) -> list[tuple[str, Any]]:
    rows = content.get(name)
    if not isinstance(rows, list):
        raise InputError(f"{path}: {name} is {shortened(rows)}, expected a list; a file of {_ANNOTATIONS}")
    return [(f"{path} {name}[{number}]", row) for number, row in enumerate(rows)]


def _image(place: str, row: Any) -> CocoImage:
    match row:
        case {"id": int(number), "width": int(width), "height": int(height)} if (
            0 < width <= _LARGEST_SIDE_PX and 0 < height <= _LARGEST_SIDE_PX
        ):
            return CocoImage(number, str(row.get("file_name", "")), width, height)
    raise InputError(f"{place}: {shortened(row)}, expected id, file_name, width and height in 1..{_LARGEST_SIDE_PX}")


def _category(place: str, row: Any) -> CocoCategory:
    match row:
        case {"id": int(number), "name": str(name)}:
            return CocoCategory(number, name, str(row.get("supercategory", "")))
    raise InputError(f"{place}: {shortened(row)}, expected id and name")


def _checked_ids(
    place: str, row: Any, image_by_id: Mapping[int, CocoImage], known_categories: set[int]
) -> tuple[CocoImage, int]:
    if not isinstance(row, dict):
        raise InputError(f"{place}: {shortened(row)}, expected an object")
    image_id, category_id = row.get("image_id"), row.get("category_id")
    if not isinstance(image_id, int) or image_id not in image_by_id:
        raise InputError(f"{place}: image_id {shortened(image_id)}, expected the id of an image of the data set")
    if not isinstance(category_id, int) or category_id not in known_categories:
        expected = ", ".join(str(number) for number in sorted(known_categories)[:10])
        raise InputError(f"{place}: category_id {shortened(category_id)}, expected one of {expected}")
    return image_by_id[image_id], category_id


def _mask(place: str, row: dict[str, Any], image: CocoImage) -> Rle:
    try:
        return rle_from_coco(row.get("segmentation"), image.height, image.width)
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def _annotation(place: str, row: dict[str, Any], image: CocoImage, category_id: int) -> CocoAnnotation:
    number, crowd = row.get("id"), row.get("iscrowd", 0)
    if not isinstance(number, int):
        raise InputError(f"{place}: id {shortened(number)}, expected a whole number")
    if crowd not in (0, 1):
        raise InputError(f"{place}: iscrowd {shortened(crowd)}, expected 0 or 1")
    mask = _mask(place, row, image)
    area, box = row.get("area"), row.get("bbox")
    match box:
        case [x, y, width, height] if all(_is_measure(value) for value in box):
            box_px = (float(x), float(y), float(width), float(height))
        case None:
            box_px = mask_box(mask)
        case _:
            raise InputError(f"{place}: bbox {shortened(box)}, expected x, y, width, height")
    if area is not None and not (_is_measure(area) and area >= 0):
        raise InputError(f"{place}: area {shortened(area)}, expected square pixels")
    return CocoAnnotation(
        number,
        image.image_id,
        category_id,
        mask,
        float(mask_area(mask) if area is None else area),
        box_px,
        bool(crowd),
        _mapping(place, "attributes", row.get("attributes")),
    )


def _is_measure(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) <= _LARGEST_MEASURE


def _mapping(place: str, name: str, value: Any) -> Mapping[str, Any]:
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise InputError(f"{place}: {name} {shortened(value)}, expected an object")
    return value
