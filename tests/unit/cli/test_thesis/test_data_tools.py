# SPDX-License-Identifier: Apache-2.0
"""`kinemap dataset`: masks from polygons, flow images, heat maps, on small made-up folders."""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from services.formats.kitti_flow import read_kitti_flow
from services.formats.label_images import read_label_image, read_label_index
from services.formats.labelme import LabelmeImage, LabelmeShape, write_labelme
from services.formats.png import read_png, write_png


def _square(label: str, x: float) -> LabelmeShape:
    return LabelmeShape(label, np.array([[x, 5.0], [x + 10.0, 5.0], [x + 10.0, 15.0], [x, 15.0]]))


@pytest.fixture
def drawn(tmp_path: Path) -> Path:
    """Two annotated images."""
    folder = tmp_path / "drawn"
    folder.mkdir()
    shapes = (_square("static_car", 0.0), _square("moving_car", 30.0))
    write_labelme(folder / "000001.json", LabelmeImage("000001.png", 60, 40, shapes))
    write_labelme(folder / "000002.json", LabelmeImage("000002.png", 60, 40, (_square("walker", 20.0),)))
    return folder


def test_polygons_become_four_kinds_of_masks(drawn: Path, kinemap: Any, tmp_path: Path) -> None:
    ended = kinemap("dataset", "labelme", drawn, "--out", "out", "--label", "walker=person:moving")
    assert ended.code == 0, ended.err
    assert "2 images, 1 moving car, 1 moving person, 1 static car" in ended.out
    masks = {
        name: read_png(tmp_path / "out" / name / "000001.png", "a mask") for name in ("objects", "movers", "moving")
    }
    assert [int((masks["objects"] == value).sum()) for value in (0, 255)] == [2200, 200]
    assert (masks["movers"][5:15, 30:40] == 255).all()
    assert (masks["movers"] > 0).sum() == 100
    assert [int((masks["moving"] == value).sum()) for value in (0, 1, 2)] == [2200, 100, 100]
    index = read_label_index(tmp_path / "out" / "instances")
    assert [(row.category, row.moving) for row in index["000001"]] == [("car", False), ("car", True)]
    labels = read_label_image(tmp_path / "out" / "instances" / "000001.png")
    assert (labels[5:15, 30:40] == index["000001"][1].label).all()
    assert json.loads((tmp_path / "out" / "labelme.json").read_text())["objects"]["static car"] == 1
    # what was written is what the rest of the program reads
    heat = kinemap("dataset", "heatmap", "out", "--out", "heat.png")
    assert heat.code == 0, heat.err
    assert json.loads((tmp_path / "heat.json").read_text())["frames"] == 2


def test_one_file_alone_and_labels_to_pass_over(drawn: Path, kinemap: Any, tmp_path: Path) -> None:
    assert kinemap("dataset", "labelme", drawn / "000001.json", "--out", "one").code == 0
    assert sorted(read_label_index(tmp_path / "one" / "instances")) == ["000001"]
    assert kinemap("dataset", "labelme", drawn, "--out", "two", "--label", "walker=ignore").code == 0
    assert read_label_index(tmp_path / "two" / "instances")["000002"] == ()


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("drawn",), ("000002.json: label 'walker': expected one of static_car, moving_car",)),
        (("nowhere",), ("nowhere: no such file or folder",)),
        (("empty",), ("empty: no JSON files",)),
        (("drawn", "--label", "walker=person"), ("--label walker=person: expected NAME=CATEGORY:moving|static",)),
        (("drawn", "--label", "walker=elf:moving"), ("--label walker=elf:moving: expected",)),
        (("drawn", "--out", "drawn/000001.json"), ("is a file, expected a folder",)),
    ],
)
def test_bad_annotations_are_one_line(
    drawn: Path, kinemap: Any, tmp_path: Path, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    (tmp_path / "empty").mkdir()
    kinemap("dataset", "labelme", "--out", "out", *arguments).is_one_line(*parts)


def _moving_texture(folder: Path, count: int = 3) -> None:
    """Images that move 4 px to the right each."""
    folder.mkdir(parents=True)
    coarse = np.random.default_rng(2).integers(0, 256, (24, 48), dtype=np.uint8)
    texture = cv2.resize(coarse, (288, 144), interpolation=cv2.INTER_CUBIC)
    for number in range(count):
        write_png(folder / f"{number:03d}.png", np.roll(texture, 4 * number, axis=1)[24:120, 48:240])


def test_flow_to_the_right_is_red_and_raw_files_hold_it(kinemap: Any, tmp_path: Path) -> None:
    _moving_texture(tmp_path / "sequence" / "image_0")
    ended = kinemap("dataset", "flow-images", "sequence", "--out", "flow", "--raw", "--longest", "4")
    assert ended.code == 0, ended.err
    assert sorted(path.name for path in (tmp_path / "flow").glob("*.png")) == ["000.png", "001.png"]
    red, green, blue = (read_png(tmp_path / "flow" / "000.png", "a picture")[20:76, 20:160].reshape(-1, 3)).mean(axis=0)
    assert red > 200
    assert max(green, blue) < 60
    flow = read_kitti_flow(tmp_path / "flow" / "raw" / "000.png").flow[20:76, 20:160]
    assert np.median(flow[..., 0]) == pytest.approx(4.0, abs=0.1)
    assert np.median(flow[..., 1]) == pytest.approx(0.0, abs=0.1)
    described = json.loads((tmp_path / "flow" / "flow-images.json").read_text())
    assert described["frames"]["000"]["next"] == "001"
    before = (tmp_path / "flow" / "000.png").read_bytes()
    assert kinemap("dataset", "flow-images", "sequence", "--out", "flow", "--longest", "4").code == 0
    assert (tmp_path / "flow" / "000.png").read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("nowhere", "--out", "out"), ("nowhere: no such folder",)),
        (("one", "--out", "out"), ("1 image, expected at least 2",)),
        (("two", "--out", "two"), ("--out two: the folder of the images",)),
        (("two", "--out", "out", "--longest", "0"), ("--longest 0: expected pixels",)),
    ],
)
def test_bad_images_are_one_line(
    kinemap: Any, tmp_path: Path, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    _moving_texture(tmp_path / "one", 1)
    _moving_texture(tmp_path / "two", 2)
    kinemap("dataset", "flow-images", *arguments).is_one_line(*parts)


def test_a_heat_map_of_sequences_as_the_simulator_writes_them(kinemap: Any, tmp_path: Path) -> None:
    for name, columns in (("00", slice(40, 80)), ("01", slice(0, 40))):
        (tmp_path / "set" / "sequences" / name / "moving").mkdir(parents=True)
        mask = np.zeros((60, 120), dtype=np.uint8)
        mask[20:40, columns] = 2
        write_png(tmp_path / "set" / "sequences" / name / "moving" / "000000.png", mask)
    ended = kinemap("dataset", "heatmap", "set", "--out", "pictures/heat.png")
    assert ended.code == 0, ended.err
    assert "middle third      50.0% of the moving pixels" in ended.out
    found = json.loads((tmp_path / "pictures" / "heat.json").read_text())
    assert (found["frames"], found["folders"]) == (2, ["00/moving", "01/moving"])
    assert found["central_ninth"] == pytest.approx(0.5)
    assert (tmp_path / "pictures" / "heat.png").stat().st_size > 0


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("nowhere", "--out", "heat.png"), ("nowhere: no such folder",)),
        (("still", "--out", "heat.jpg"), ("--out heat.jpg: expected a name that ends in .png",)),
        (("still", "--out", "heat.png"), ("nothing moves in 1 masks",)),
    ],
)
def test_bad_masks_are_one_line(
    kinemap: Any, tmp_path: Path, arguments: tuple[str, ...], parts: tuple[str, ...]
) -> None:
    (tmp_path / "still").mkdir()
    write_png(tmp_path / "still" / "0.png", np.ones((4, 4), dtype=np.uint8))
    kinemap("dataset", "heatmap", *arguments).is_one_line(*parts)
