# SPDX-License-Identifier: Apache-2.0
"""LabelMe's files: read as the program writes them, refused in one line otherwise."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from services.formats.labelme import LabelmeImage, LabelmeShape, read_labelme, write_labelme
from services.runtime.errors import InputError

SQUARE = {"label": "static_car", "points": [[10, 5], [20.0, 5.0], [20, 15], [10, 15]], "shape_type": "polygon"}


def _file(folder: Path, *shapes: Any, **fields: Any) -> Path:
    content = {"version": "5.2.1", "flags": {}, "shapes": list(shapes), "imagePath": "..\\images\\000003.png"}
    path = folder / "000003.json"
    path.write_text(json.dumps({**content, "imageData": None, "imageHeight": 40, "imageWidth": 60, **fields}))
    return path


def test_a_file_of_the_program_is_read_and_the_polygon_fills_its_pixels(tmp_path: Path) -> None:
    image = read_labelme(_file(tmp_path, {**SQUARE, "group_id": 4, "flags": {}}))
    assert (image.name, image.width, image.height) == ("000003", 60, 40)
    assert (image.shapes[0].label, image.shapes[0].group_id) == ("static_car", 4)
    mask = image.mask(image.shapes[0])
    assert mask.shape == (40, 60)
    assert mask[5:15, 10:20].all()
    assert mask.sum() == 100


def test_rectangles_and_circles_have_areas_too(tmp_path: Path) -> None:
    rectangle = {"label": "a", "points": [[20, 15], [10, 5]], "shape_type": "rectangle"}
    circle = {"label": "b", "points": [[30, 20], [30, 30]], "shape_type": "circle"}
    image = read_labelme(_file(tmp_path, rectangle, circle))
    assert image.mask(image.shapes[0])[5:15, 10:20].all()
    assert image.mask(image.shapes[0]).sum() == 100
    assert image.mask(image.shapes[1]).sum() == pytest.approx(np.pi * 100, rel=0.03)


def test_what_lies_outside_of_the_image_is_cut_off() -> None:
    corners = np.array([[-20.0, -10.0], [10.0, -10.0], [10.0, 100.0], [-20.0, 100.0]])
    image = LabelmeImage("a.png", 60, 40, (LabelmeShape("car", corners),))
    mask = image.mask(image.shapes[0])
    assert mask[:, :10].all()
    assert mask.sum() == 400


def test_what_is_written_is_read_again(tmp_path: Path) -> None:
    shape = LabelmeShape("moving_car", np.array([[1.5, 2.0], [9.0, 2.0], [5.0, 8.25]]), "polygon", 7)
    write_labelme(tmp_path / "a.json", LabelmeImage("a.jpg", 60, 40, (shape,)))
    again = read_labelme(tmp_path / "a.json")
    assert (again.image_path, again.width, again.height) == ("a.jpg", 60, 40)
    assert again.shapes[0].points_px.tolist() == shape.points_px.tolist()
    assert (again.shapes[0].label, again.shapes[0].group_id) == ("moving_car", 7)


@pytest.mark.parametrize(
    ("shape", "part"),
    [
        ({**SQUARE, "points": [[1, 2], [3, 4]]}, "shape 0: a polygon of 2 points, expected at least 3"),
        ({**SQUARE, "shape_type": "line"}, 'shape 0: a "line", expected polygon, rectangle, circle'),
        ({**SQUARE, "points": [[1, 2], [3, None], [4, 5]]}, "shape 0: "),
        ({"points": SQUARE["points"]}, 'expected {"label": NAME'),
        ("car", "shape 0: "),
    ],
)
def test_a_shape_that_is_none_is_named(tmp_path: Path, shape: Any, part: str) -> None:
    with pytest.raises(InputError) as raised:
        read_labelme(_file(tmp_path, shape))
    assert part in str(raised.value)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("fields", [{"imageHeight": None}, {"imageWidth": 0}, {"imagePath": ""}, {"shapes": {}}])
def test_a_file_of_another_kind_is_refused(tmp_path: Path, fields: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="expected LabelMe's annotations"):
        read_labelme(_file(tmp_path, **fields))
