# SPDX-License-Identifier: Apache-2.0
import hashlib
import os
import re
import shutil
from pathlib import Path
from typing import Any

import pytest
import torch

from services.runtime.errors import InputError
from services.segmenter.mask_rcnn.network import MaskRcnn
from services.segmenter.weights.catalogue import PUBLIC_MODELS, public_model
from services.segmenter.weights.model_file import (
    ModelDescription,
    load_network,
    load_solov2,
    read_description,
    save_model,
)
from services.segmenter.weights.public_checkpoint import read_checkpoint
from services.segmenter.weights.store import cached_models, import_file


def test_a_checkpoint_becomes_a_model_with_its_categories(cache: Path, checkpoint: Path, content: Any) -> None:
    path = import_file(checkpoint)
    assert path == cache / "mine.safetensors"
    network, description = load_network(path)
    assert description.variant == "solov2-light_r18"
    assert description.categories == ("person", "car")
    assert description.input_box == (852, 448)
    assert (description.source, len(description.source_sha256)) == ("mine.pth", 64)
    assert not network.training
    for name, value in network.state_dict().items():
        torch.testing.assert_close(value, content["state_dict"][name])
    assert cached_models() == [path]
    assert checkpoint.is_file()


def test_a_state_dict_alone_and_a_model_file_are_taken_too(cache: Path, content: Any, tmp_path: Path) -> None:
    torch.save(content, tmp_path / "a.pth")
    first = import_file(tmp_path / "a.pth")
    shutil.copy(first, tmp_path / "b.safetensors")
    assert import_file(tmp_path / "b.safetensors") == cache / "b.safetensors"
    assert read_description(cache / "b.safetensors") == read_description(first)


def test_a_published_name_promises_its_checksum(cache: Path, checkpoint: Path, tmp_path: Path) -> None:
    digest = hashlib.sha256(checkpoint.read_bytes()).hexdigest()
    shutil.copy(checkpoint, tmp_path / f"right-{digest[:8]}.pth")
    import_file(tmp_path / f"right-{digest[:8]}.pth")
    shutil.copy(checkpoint, tmp_path / "wrong-00c0ffee.pth")
    with pytest.raises(
        InputError, match=f"wrong-00c0ffee.pth: its SHA-256 begins with {digest[:8]}, expected 00c0ffee"
    ):
        import_file(tmp_path / "wrong-00c0ffee.pth")
    assert cached_models() == [cache / f"right-{digest[:8]}.safetensors"]


class _Malice:
    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, ("was-run",)


@pytest.mark.usefixtures("cache")
class TestRefused:
    """Each with its name and the reason, and nothing in the cache."""

    @pytest.fixture(autouse=True)
    def _nothing_is_kept(self, cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
        monkeypatch.chdir(tmp_path)
        yield
        assert cached_models() == []
        assert not list(cache.glob("*")) if cache.is_dir() else True

    def _refused(self, path: Path, why: str) -> None:
        with pytest.raises(InputError, match=f"{re.escape(str(path))}: {why}"):
            import_file(path)

    def test_a_file_that_would_run_code(self, tmp_path: Path, content: Any) -> None:
        torch.save({**content, "hook": _Malice()}, tmp_path / "evil.pth")
        self._refused(tmp_path / "evil.pth", "refused, it holds more than tensors")
        assert not (tmp_path / "was-run").exists()

    @pytest.mark.parametrize("kept", [0, 10, 1000, 1_000_000])
    def test_a_file_that_is_cut_off(self, tmp_path: Path, checkpoint: Path, kept: int) -> None:
        (tmp_path / "cut.pth").write_bytes(checkpoint.read_bytes()[:kept])
        self._refused(tmp_path / "cut.pth", "(not a whole checkpoint|refused)")

    def test_another_network(self, tmp_path: Path) -> None:
        torch.save({"state_dict": {"fc.weight": torch.zeros(2, 2)}}, tmp_path / "other.pth")
        self._refused(tmp_path / "other.pth", r"has no mask_head\.conv_cls\.weight")

    def test_other_shapes(self, tmp_path: Path, content: Any) -> None:
        state = {**content["state_dict"], "backbone.conv1.weight": torch.zeros(64, 3, 3, 3)}
        torch.save({**content, "state_dict": state}, tmp_path / "other.pth")
        self._refused(tmp_path / "other.pth", "its tensors fit none of solov2-compact_lite0, ")

    def test_deformable_convolutions(self, tmp_path: Path, content: Any) -> None:
        state = {**content["state_dict"], "mask_head.cls_convs.1.conv.conv_offset.weight": torch.zeros(1)}
        torch.save({**content, "state_dict": state}, tmp_path / "dcn.pth")
        self._refused(tmp_path / "dcn.pth", "has deformable convolutions")

    def test_categories_without_names(self, tmp_path: Path, content: Any) -> None:
        torch.save({"state_dict": content["state_dict"]}, tmp_path / "nameless.pth")
        self._refused(tmp_path / "nameless.pth", "2 categories, expected COCO's 80")

    def test_no_file_and_a_model_file_that_is_none(self, tmp_path: Path) -> None:
        self._refused(tmp_path / "absent.pth", "no such file")
        (tmp_path / "text.safetensors").write_text("hello")
        with pytest.raises(InputError, match=r"text\.safetensors: not a whole safetensors file"):
            import_file(tmp_path / "text.safetensors")


def test_a_model_in_16_bits_is_half_the_size_and_loads(tmp_path: Path, content: Any) -> None:
    description = ModelDescription("solov2-light_r18", ("person", "car"), (640, 192), "a test")
    save_model(tmp_path / "full.safetensors", description, content["state_dict"])
    save_model(tmp_path / "half.safetensors", description, content["state_dict"], half=True)
    sizes = [(tmp_path / name).stat().st_size for name in ("full.safetensors", "half.safetensors")]
    assert sizes[1] < 0.51 * sizes[0]
    network, found = load_network(tmp_path / "half.safetensors")
    assert found == description
    assert network.state_dict()["backbone.conv1.weight"].dtype == torch.float32


def test_models_are_found_by_name_file_and_variant() -> None:
    assert public_model("solov2-light_r18").url == (
        "https://download.openmmlab.com/mmdetection/v2.0/solov2/solov2_light_r18_fpn_3x_coco/"
        "solov2_light_r18_fpn_3x_coco_20220511_083717-75fa355b.pth"
    )
    assert public_model("solov2_r50").name == "solov2_r50_fpn_ms-3x_coco"
    assert {model.sha256_prefix for model in PUBLIC_MODELS} >= {"75fa355b", "a357fa23", "fed092d4", "c559a076"}
    with pytest.raises(InputError, match="solov2_r101-dcn_fpn_ms-3x_coco: needs deformable convolutions"):
        public_model("solov2_r101-dcn_fpn_ms-3x_coco")
    with pytest.raises(InputError, match="yolo: is no known model, expected one of solov2-light_r18_fpn_ms-3x_coco, "):
        public_model("yolo")


def test_mask_rcnn_is_told_by_its_tensors(tmp_path: Path, cache: Path) -> None:
    with torch.device("meta"):
        shapes = {name: value.shape for name, value in MaskRcnn(50, 80).state_dict().items()}
    content = {"meta": {}, "state_dict": {name: torch.zeros(()).expand(shape) for name, shape in shapes.items()}}
    torch.save(content, tmp_path / "mine.pth")
    description, state = read_checkpoint(tmp_path / "mine.pth", "")
    assert (description.variant, description.input_box) == ("mask-rcnn_r50", (1333, 800))
    assert len(description.categories) == 80
    assert state.keys() == shapes.keys()
    assert public_model("mask-rcnn_r50").url == (
        "https://download.openmmlab.com/mmdetection/v2.0/mask_rcnn/mask_rcnn_r50_fpn_1x_coco/"
        "mask_rcnn_r50_fpn_1x_coco_20200205-d4b0c5d6.pth"
    )


def test_mask_rcnn_is_no_network_to_train(tmp_path: Path) -> None:
    path = tmp_path / "baseline.safetensors"
    description = ModelDescription("mask-rcnn_r50", ("car",), (96, 64), "a test")
    save_model(path, description, MaskRcnn(50, 1).state_dict(), half=True)
    assert isinstance(load_network(path)[0], MaskRcnn)
    with pytest.raises(InputError, match=r"mask-rcnn_r50, expected one of solov2-compact_lite0"):
        load_solov2(path)
