# SPDX-License-Identifier: Apache-2.0
"""`kinemap train segmenter` on a few painted images."""

from pathlib import Path

import cv2
import pytest
from typer.testing import CliRunner

from services.cli.app import app
from services.formats.coco import CocoAnnotation, CocoCategory, CocoDataset, CocoImage, write_coco
from services.formats.rle import encode_mask
from services.runtime.errors import InputError
from services.segmenter.weights.model_file import load_solov2
from tests.unit.segmenter.training.painted_samples import painted_sample

CATEGORIES = (CocoCategory(1, "person"), CocoCategory(3, "car"))


@pytest.fixture
def data(tmp_path: Path) -> str:
    images, annotations = [], []
    for number in range(1, 4):
        sample = painted_sample(number)
        cv2.imwrite(str(tmp_path / f"{number}.png"), sample.image)
        images.append(CocoImage(number, f"{number}.png", sample.image.shape[1], sample.image.shape[0]))
        for mask, label in zip(sample.masks, sample.labels, strict=True):
            category = CATEGORIES[label].category_id
            annotations.append(CocoAnnotation.of_mask(len(annotations) + 1, number, category, encode_mask(mask)))
    path = tmp_path / "painted.json"
    write_coco(path, CocoDataset(tuple(images), CATEGORIES, tuple(annotations)))
    return str(path)


def _train(*arguments: str) -> str:
    fixed = ["--batch", "2", "--workers", "0", "--size", "64x64", "--threads", "1", "--precision", "fp32"]
    result = CliRunner().invoke(app, ["train", "segmenter", *arguments, *fixed], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return result.output


def test_learns_judges_saves_and_goes_on_for_longer(data: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    said = _train(data, "--validate", data, "--out", str(out), "--steps", "2", "--save-every", "1")
    assert "step 1 of 2" in said
    assert "mask AP50" in said
    _, description = load_solov2(out / "model.safetensors")
    assert description.variant == "solov2-compact_lite0"
    assert description.categories[:3] == ("person", "bicycle", "car")
    assert (out / "curves.png").stat().st_size > 1000
    assert "step 3 of 3" in _train(data, "--out", str(out), "--steps", "3", "--save-every", "1", "--size", "96x64")


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        (("--size", "100x64"), "--size 100x64: expected multiples of 32"),
        (("--variant", "yolo"), "--variant yolo: expected one of solov2-compact_lite0"),
        (("--precision", "int3"), "--precision int3: expected one of auto, fp32, fp16, bf16"),
        (("--backbone", "none.pth"), "none.pth: no such file, expected the weights of efficientnet-lite0"),
        (("--category", "dog"), "0 of the categories dog"),
    ],
)
def test_refuses_in_one_line(data: str, tmp_path: Path, arguments: tuple[str, ...], why: str) -> None:
    with pytest.raises(InputError, match=why):
        CliRunner().invoke(
            app, ["train", "segmenter", data, "--out", str(tmp_path / "out"), *arguments], catch_exceptions=False
        )
