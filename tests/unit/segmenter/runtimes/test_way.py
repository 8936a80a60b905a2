# SPDX-License-Identifier: Apache-2.0
import pytest

from services.runtime.errors import InputError, ResourceError
from services.segmenter.runtimes import way as module
from services.segmenter.runtimes.way import Way, asked_ways, precisions, versions, ways_here

TORCH, TORCH_16 = Way("torch", "fp32"), Way("torch", "bf16")
OPENVINO, OPENVINO_16 = Way("openvino", "fp32"), Way("openvino", "bf16")
HERE = (TORCH, OPENVINO, TORCH_16, OPENVINO_16)


@pytest.fixture(autouse=True)
def multiplies(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "multiplies_bfloat16", lambda: True)


def _only(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    monkeypatch.setattr(module, "_has", names.__contains__)


def test_libraries_count_only_where_the_network_can_get_into_them(monkeypatch: pytest.MonkeyPatch) -> None:
    _only(monkeypatch, "openvino", "onnxruntime")
    assert ways_here("cpu") == (TORCH, TORCH_16)
    _only(monkeypatch, "openvino", "onnx")
    assert ways_here("cpu") == HERE
    _only(monkeypatch, "onnxruntime", "onnx")
    assert ways_here("cpu") == (TORCH, Way("onnxruntime", "fp32"), TORCH_16)
    assert ways_here("cuda") == (Way("torch", "fp32"), Way("torch", "fp16"))


def test_16_bits_only_where_the_processor_multiplies_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "multiplies_bfloat16", lambda: False)
    assert precisions("cpu", "openvino") == ("fp32",)


def test_what_is_asked_for() -> None:
    assert asked_ways(HERE, "auto", "auto", "cpu") == HERE
    assert asked_ways(HERE, "auto", "bf16", "cpu") == (TORCH_16, OPENVINO_16)
    assert asked_ways(HERE, "openvino", "auto", "cpu") == (OPENVINO, OPENVINO_16)
    assert asked_ways(HERE, "openvino", "bf16", "cpu") == (OPENVINO_16,)
    assert asked_ways(HERE, "torch", "fp16", "cpu") == (Way("torch", "fp16"),)


def test_what_cannot_be_had_is_named() -> None:
    with pytest.raises(ResourceError, match=r"runtime onnxruntime: not installed.*pip install onnxruntime onnx"):
        asked_ways(HERE, "onnxruntime", "auto", "cpu")
    with pytest.raises(InputError, match=r"runtime openvino: runs on processors only, expected segmenter.device cpu"):
        asked_ways(HERE, "openvino", "auto", "cuda")
    with pytest.raises(InputError, match=r"precision bf16: onnxruntime has fp32 on this processor"):
        asked_ways((*HERE, Way("onnxruntime", "fp32")), "onnxruntime", "bf16", "cpu")


def test_versions_are_those_of_the_libraries_in_use() -> None:
    assert versions([TORCH]).startswith("torch 2.")
    assert str(OPENVINO_16) == "openvino bf16"
