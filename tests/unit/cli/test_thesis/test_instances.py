# SPDX-License-Identifier: Apache-2.0
"""`kinemap thesis instances` on a made-up folder of KITTI's layout."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from schemas.records import Image, Instance, Instances
from services.cli.thesis.instances_score import score_on_kitti
from services.cli.thesis.segmenter_run import TimedSegmenter
from services.formats.kitti_semantic import semantic_frames
from services.formats.label_images import LabelledInstance, write_label_image, write_label_index
from services.formats.png import write_png
from services.segmenter.backend import FrameContext
from services.segmenter.networks import build
from services.segmenter.weights.model_file import ModelDescription, save_model

NAMES = ("000000_10", "000001_10")


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """Two images, each with two cars and a person; masks of a perfect and of a poor segmenter."""
    for folder in ("kitti/training/image_2", "kitti/training/instance", "good", "poor"):
        (tmp_path / folder).mkdir(parents=True)
    for name in NAMES:
        truth = np.zeros((40, 60), dtype=np.uint16)
        truth[5:15, 5:25], truth[20:35, 30:50] = 26 * 256 + 1, 26 * 256 + 2
        truth[20:30, 2:8] = 24 * 256 + 1
        write_png(tmp_path / "kitti/training/image_2" / f"{name}.png", np.zeros((40, 60, 3), dtype=np.uint8))
        write_png(tmp_path / "kitti/training/instance" / f"{name}.png", truth)
        labels = np.select([truth == 26 * 256 + 1, truth == 26 * 256 + 2, truth == 24 * 256 + 1], [1, 2, 3], 0)
        write_label_image(tmp_path / "good" / f"{name}.png", labels)
        write_label_image(tmp_path / "poor" / f"{name}.png", labels)
    sure = (LabelledInstance(1, "car", 0.9), LabelledInstance(2, "car", 0.8), LabelledInstance(3, "person", 0.9))
    write_label_index(tmp_path / "good", dict.fromkeys(NAMES, sure))
    unsure = (sure[0], LabelledInstance(2, "car", 0.2), sure[2])
    write_label_index(tmp_path / "poor", {NAMES[0]: unsure})
    return tmp_path / "kitti"


def test_segmenters_stand_side_by_side_with_the_thesis(data: Path, kinemap: Any, tmp_path: Path) -> None:
    ended = kinemap(
        "thesis", "instances", "--data", data, "--predictions", "poor", "--predictions", "good", "--out", "out"
    )
    assert ended.code == 0, ended.err
    found = json.loads((tmp_path / "out" / "instances.json").read_text())
    poor, good = found["segmenters"]
    assert (good["precision"]["ap_thesis"], good["precision"]["ap"]) == (1.0, 1.0)
    assert good["precision"]["true_instances"] == 4
    # one of four cars: the other scores 0.2, and the second image has no word
    assert poor["precision"]["found_instances"] == 1
    assert poor["skipped"] == 1
    assert good["gain_percent"] == pytest.approx(100.0 * (1.0 / poor["precision"]["ap_thesis"] - 1.0))
    assert good["seconds"] is None  # label images: no network ran
    assert "| thesis, Mask R-CNN | - |" in ended.out
    assert (tmp_path / "out" / "instances.png").stat().st_size > 0


class CarFinder:
    """A network in the backend's place: everything that is there is a car."""

    missing_frames = 0

    def segment(self, image: Image, context: FrameContext) -> Instances:
        labels = np.zeros(image.pixels.shape[:2], dtype=np.uint32)
        labels[5:15, 5:25] = 7
        return Instances(image.timestamp_ns, labels, (Instance(7, "car", 0.9, (5.0, 5.0, 20.0, 10.0)),))

    def close(self) -> None:
        """Nothing is held open."""


def test_whatever_is_a_backend_is_scored_and_timed(data: Path) -> None:
    score = score_on_kitti("finder", TimedSegmenter(CarFinder()), semantic_frames(data), "car")
    assert score.precision.ap == pytest.approx(51 / 101)
    assert score.seconds is not None
    assert score.seconds > 0.0


@pytest.mark.usefixtures("without_network")
@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("--data", "nowhere"), ("--data nowhere: no such data set", "training/instance/*.png")),
        (("--data", "kitti"), ("no instances/ and no segmenter", "expected --predictions FOLDER")),
        (("--data", "kitti", "--category", "dog"), ("--category dog: expected one of person, car",)),
        (("--data", "kitti", "--predictions", "none"), ("instances none: no such folder",)),
        (("--data", "kitti", "--predictions", "good", "--predictions", "good"), ("was given already",)),
    ],
)
def test_bad_input_is_one_line(data: Path, kinemap: Any, arguments: tuple[str, ...], parts: tuple[str, ...]) -> None:
    kinemap("thesis", "instances", *arguments, "--out", "out").is_one_line(*parts)
    assert not (data.parent / "out").exists()


def test_predictions_of_other_images_are_refused(data: Path, kinemap: Any, tmp_path: Path) -> None:
    write_label_index(tmp_path / "poor", {"elsewhere": ()})
    ended = kinemap("thesis", "instances", "--data", data, "--predictions", "poor", "--out", "out")
    ended.is_one_line("poor: no word about any image", "'000000_10'")


def test_two_networks_are_compared_by_one_command(data: Path, kinemap: Any, tmp_path: Path) -> None:
    torch.manual_seed(0)
    baseline, other = tmp_path / "mask-rcnn_r50.safetensors", tmp_path / "solov2-compact_lite0.safetensors"
    for path in (baseline, other):
        network = build(path.stem, 2)
        description = ModelDescription(path.stem, ("person", "car"), (96, 64), "a test")
        save_model(path, description, network.state_dict(), half=True)
    ended = kinemap(
        *("thesis", "instances", "--data", data, "--out", "out", "--set", "segmenter.precision=fp32"),
        *("--network", baseline, "--network", other),
    )
    assert ended.code == 0, ended.err
    found = json.loads((tmp_path / "out" / "instances.json").read_text())
    assert [side["name"] for side in found["segmenters"]] == [baseline.name, other.name]
    assert all(side["seconds"] > 0 for side in found["segmenters"])
    twice = kinemap("thesis", "instances", "--data", data, "--out", "out2", "--network", other, "--network", other)
    assert twice.code == 2
    assert "one of that name was given already" in twice.err
