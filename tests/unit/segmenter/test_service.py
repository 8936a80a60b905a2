# SPDX-License-Identifier: Apache-2.0
"""The segmenter service: which backend it takes, and what it gives for a frame."""

from pathlib import Path

import numpy as np
import pytest

from schemas import topics
from schemas.records import FrameManifest, Image, Instances, TrueInstances, TrueObject
from services.runtime.config import Config
from services.runtime.config.camera import CameraConfig
from services.runtime.config.segmenter import SegmenterConfig
from services.runtime.envelope import Envelope
from services.runtime.errors import InputError
from services.runtime.service import Bundle
from services.segmenter.label_images import LabelImages
from services.segmenter.network_instances import NetworkInstances
from services.segmenter.no_instances import NoInstances
from services.segmenter.service import SegmenterService, choose_backend
from services.segmenter.truth import TrueLabels
from services.segmenter.weights import choice
from tests.unit.segmenter.drawn_model import save_drawn_model


def _config(camera_input: str = "simulator", **segmenter: object) -> Config:
    config = Config()
    config.camera = CameraConfig(input=camera_input)
    config.segmenter = SegmenterConfig.model_validate(segmenter)
    return config


def _bundle(image: Image, name: str, truth: TrueInstances | None = None) -> Bundle:
    records = {topics.IMAGE: image, topics.MANIFEST: FrameManifest(image.timestamp_ns, "test", name, ())}
    if truth is not None:
        records[topics.TRUE_INSTANCES] = truth
    return Bundle(Envelope("test", 0, image.timestamp_ns), records)


def _segment(service: SegmenterService, bundle: Bundle) -> Instances:
    (outgoing,) = service.process(bundle)
    assert outgoing.topic is topics.INSTANCES
    assert isinstance(outgoing.record, Instances)
    return outgoing.record


@pytest.fixture
def truth(image: Image) -> TrueInstances:
    labels = np.zeros((20, 30), dtype=np.uint32)
    labels[0:5, 0:5] = 70000
    labels[10:15, 10:15] = 2
    still, away = (0.0, 0.0, 0.0), (5.0, 0.0, 0.0)
    objects = (
        TrueObject(70000, "car", True, away, still, (0, 0, 5, 5)),
        TrueObject(2, "chair", True, away, still, (10, 10, 5, 5)),
    )
    return TrueInstances(image.timestamp_ns, labels, objects)


def test_auto_takes_the_masks_beside_the_input_else_what_there_is(
    instances: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(choice, "SHIPPED_WEIGHTS", tmp_path / "none.safetensors")
    assert isinstance(choose_backend(_config(str(tmp_path))), LabelImages)
    assert isinstance(choose_backend(_config("simulator")), TrueLabels)
    assert isinstance(choose_backend(_config("simulator", instances=str(instances))), LabelImages)
    assert isinstance(choose_backend(_config(str(tmp_path), backend="truth")), TrueLabels)
    assert isinstance(choose_backend(_config(str(tmp_path), backend="none")), NoInstances)
    monkeypatch.setattr(choice, "SHIPPED_WEIGHTS", save_drawn_model(tmp_path / "shipped.safetensors"))
    assert isinstance(choose_backend(_config("simulator", runtime="torch", precision="fp32")), NetworkInstances)


def test_auto_takes_the_instances_of_a_session(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.mcap: no such file"):
        choose_backend(_config(str(tmp_path / "none.mcap")))
    assert isinstance(choose_backend(_config(str(tmp_path / "none.mcap"), backend="truth")), TrueLabels)


def test_masks_that_were_asked_for_must_be_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="instances: no such folder"):
        choose_backend(_config(str(tmp_path), backend="masks"))
    with pytest.raises(InputError, match="elsewhere: no such folder"):
        choose_backend(_config(str(tmp_path), instances=str(tmp_path / "elsewhere")))


def test_categories_are_cocos() -> None:
    with pytest.raises(ValueError, match="'van' is none of COCO's 80 categories"):
        SegmenterConfig(categories=("car", "van"))


def test_masks_by_frame_name(instances: Path, tmp_path: Path, image: Image) -> None:
    service = SegmenterService(_config(str(tmp_path)))
    found = _segment(service, _bundle(image, "000000"))
    assert [(item.instance_id, item.category) for item in found.instances] == [(1, "car"), (5, "person")]
    assert service.metrics() == {"frames_without_masks": 0, "segmented_every": 1}
    assert _segment(service, _bundle(image, "000099")).skipped
    assert service.metrics()["frames_without_masks"] == 1


def test_truth_of_the_configured_categories(image: Image, truth: TrueInstances) -> None:
    service = SegmenterService(_config(backend="truth"))
    found = _segment(service, _bundle(image, "000000", truth))
    assert [(item.instance_id, item.score, item.box_px) for item in found.instances] == [(70000, 1.0, (0, 0, 5, 5))]
    assert set(np.unique(found.labels)) == {0, 70000}
    assert _segment(service, _bundle(image, "000001")).skipped
    assert service.metrics()["frames_without_masks"] == 1


def test_truth_of_another_size_is_named(image: Image, truth: TrueInstances) -> None:
    small = TrueInstances(truth.timestamp_ns, truth.labels[:10], truth.objects)
    with pytest.raises(InputError, match="true labels of frame 000000: 30x10 px, expected 30x20"):
        _segment(SegmenterService(_config(backend="truth")), _bundle(image, "000000", small))


def test_none_skips_all(image: Image, truth: TrueInstances) -> None:
    found = _segment(SegmenterService(_config(backend="none")), _bundle(image, "000000", truth))
    assert (found.skipped, found.instances, found.timestamp_ns) == (True, (), 123)
