# SPDX-License-Identifier: Apache-2.0
"""The network's backend: what becomes of what it finds, and which network it is."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import torch

from schemas import topics
from schemas.records import FrameManifest, Image
from services.runtime.config import Config
from services.runtime.config.segmenter import SegmenterConfig
from services.runtime.envelope import Envelope
from services.runtime.errors import InputError
from services.runtime.service import Bundle
from services.segmenter.backend import FrameContext, InstanceFilter
from services.segmenter.configured_network import configured_network
from services.segmenter.network_instances import NetworkInstances
from services.segmenter.service import SegmenterService, choose_backend
from services.segmenter.solov2.instances import SegmentedInstances
from services.segmenter.truth import TrueLabels
from services.segmenter.weights import choice
from services.segmenter.weights.choice import choose_model
from tests.unit.segmenter.drawn_model import CATEGORIES, save_drawn_model


class _Found:
    """Finds a chair over a car over a person over an unsure car, in a row of pixels."""

    def segment(self, image: npt.NDArray[np.uint8]) -> SegmentedInstances:
        masks = torch.zeros(4, *image.shape[:2], dtype=torch.bool)
        for number, (first, last) in enumerate(((0, 4), (2, 8), (6, 10), (9, 14))):
            masks[number, 0, first:last] = True
        return SegmentedInstances(masks, torch.tensor([2, 1, 0, 1]), torch.tensor([0.9, 0.8, 0.5, 0.1]))


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of the test's own, and no shipped weights."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(choice, "SHIPPED_WEIGHTS", tmp_path / "default.safetensors")
    return tmp_path / "cache" / "kinemap" / "weights"


def _backend(*categories: str, min_score: float = 0.3) -> NetworkInstances:
    return NetworkInstances(_Found(), CATEGORIES, InstanceFilter(frozenset(categories), min_score))


def test_a_pixel_is_the_surest_ones_and_what_is_left_out_hides_nothing(image: Image) -> None:
    found = _backend("person", "car").segment(image, FrameContext("000000"))
    assert [(item.instance_id, item.category) for item in found.instances] == [(1, "car"), (2, "person")]
    assert found.labels[0, :15].tolist() == [0, 0, 1, 1, 1, 1, 1, 1, 2, 2, 0, 0, 0, 0, 0]
    assert found.instances[1].box_px == (8, 0, 2, 1)
    assert found.timestamp_ns == image.timestamp_ns


def test_any_category_can_be_asked_for(image: Image) -> None:
    found = _backend("chair", "car", min_score=0.05).segment(image, FrameContext("000000"))
    assert [item.category for item in found.instances] == ["chair", "car", "car"]
    assert [item.score for item in found.instances] == pytest.approx([0.9, 0.8, 0.1])


def test_configured_file_then_public_models_then_what_is_shipped(cache: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no network for the segmenter.*kinemap weights pull solov2-light_r18"):
        choose_model(None)
    shipped = save_drawn_model(tmp_path / "default.safetensors")
    assert choose_model(None).path == shipped
    public = save_drawn_model(cache / "solov2_r50_fpn_1x_coco.safetensors")
    assert choose_model(None).path == public
    light = save_drawn_model(cache / "solov2-light_r34_fpn_ms-3x_coco.safetensors")
    assert choose_model(None).path == light
    assert choose_model("solov2_r50_fpn_1x_coco").path == public
    assert choose_model(str(shipped)).path == shipped
    own = save_drawn_model(cache / "mine.safetensors")
    assert choose_model("mine").path == own
    with pytest.raises(InputError, match=r"solov2_r101: not in .*`kinemap weights pull solov2_r101_fpn_ms-3x_coco`"):
        choose_model("solov2_r101")
    with pytest.raises(InputError, match="weights yolo: is no known model"):
        choose_model("yolo")
    with pytest.raises(InputError, match=r"gone\.safetensors: no such file"):
        choose_model(str(tmp_path / "gone.safetensors"))


def test_auto_takes_the_network_where_there_is_one(tmp_path: Path) -> None:
    config = Config()
    assert isinstance(choose_backend(config), TrueLabels)
    save_drawn_model(tmp_path / "default.safetensors")
    assert isinstance(choose_backend(config), NetworkInstances)


def test_categories_that_it_does_not_know_are_named(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    weights = str(save_drawn_model(tmp_path / "mine.safetensors"))
    chosen = InstanceFilter(frozenset({"dog"}))
    with pytest.raises(InputError, match=r"mine\.safetensors knows none of dog, only person, car, chair"):
        configured_network(SegmenterConfig(weights=weights, categories=("dog",)), chosen)
    settings = SegmenterConfig(weights=weights, categories=("dog", "car"), runtime="torch", precision="fp32")
    configured_network(settings, chosen)
    assert "categories_unknown" in caplog.text


def test_the_service_segments_every_nth_frame_and_says_of_the_others_that_it_skipped_them(tmp_path: Path) -> None:
    config = Config()
    config.segmenter = SegmenterConfig(
        backend="solov2",
        weights=str(save_drawn_model(tmp_path / "mine.safetensors")),
        every=3,
        min_score=0,
        runtime="torch",
        precision="fp32",
    )
    service = SegmenterService(config)
    pixels = np.random.default_rng(0).integers(0, 255, (64, 96, 3), np.uint8)
    skipped = []
    for sequence in range(5):
        image = Image(1000 + sequence, pixels)
        records = {topics.IMAGE: image, topics.MANIFEST: FrameManifest(image.timestamp_ns, "test", "name", ())}
        (outgoing,) = service.process(Bundle(Envelope("test", sequence, image.timestamp_ns), records))
        assert outgoing.record.timestamp_ns == image.timestamp_ns
        skipped.append(outgoing.record.skipped)
    assert skipped == [False, True, True, False, True]
    assert service.metrics() == {"frames_without_masks": 0, "segmented_every": 3}


def test_sixteen_bits_see_the_same(tmp_path: Path) -> None:
    pixels = np.random.default_rng(1).integers(0, 255, (64, 96, 3), np.uint8)
    weights = str(save_drawn_model(tmp_path / "mine.safetensors"))
    found = []
    for precision in ("fp32", "bf16"):
        settings = SegmenterConfig.model_validate(
            {"weights": weights, "runtime": "torch", "precision": precision, "min_score": 0}
        )
        backend = configured_network(settings, InstanceFilter(frozenset(CATEGORIES)))
        found.append(backend.segment(Image(5, pixels), FrameContext("name")))
    assert found[0].instances
    agreement = np.mean(found[0].labels == found[1].labels)
    assert agreement > 0.9
