# SPDX-License-Identifier: Apache-2.0
"""Every library that is installed computes what torch computes."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import Tensor

from services.segmenter.network_runs import NetworkRuns
from services.segmenter.runtimes.dense import Dense
from services.segmenter.runtimes.export import Exporter
from services.segmenter.runtimes.export_cache import exports_folder
from services.segmenter.runtimes.torch_dense import TorchDense
from services.segmenter.runtimes.way import Way, ways_here
from services.segmenter.solov2.folding import folded
from services.segmenter.solov2.head import HeadOutput
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import VARIANTS

SIZES = ((64, 96), (96, 64))
EXACT_WAYS = tuple(way for way in ways_here("cpu") if way.precision == "fp32" and way.runtime != "torch")


@pytest.fixture(autouse=True, scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("cache")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder))
        yield folder


@pytest.fixture(scope="module")
def network() -> SoloV2:
    torch.manual_seed(3)
    return folded(SoloV2(VARIANTS["solov2-compact_lite0"], 3).eval())


def _dense(network: SoloV2, way: Way) -> Dense:
    exporter = Exporter(network)
    if way.runtime == "openvino":
        from services.segmenter.runtimes.openvino_dense import OpenVinoDense

        return OpenVinoDense(exporter, way.precision, threads=1)
    from services.segmenter.runtimes.onnxruntime_dense import OnnxRuntimeDense

    return OnnxRuntimeDense(exporter, threads=1)


def _tensors(output: HeadOutput) -> list[Tensor]:
    return [tensor.clone() for tensor in (*output.kernels, *output.categories, output.mask_features)]


@pytest.mark.parametrize("runtime", ["openvino", "onnxruntime"])
def test_the_same_numbers_in_every_size_and_the_same_bytes_again(network: SoloV2, runtime: str) -> None:
    way = next((way for way in EXACT_WAYS if way.runtime == runtime), None)
    if way is None:
        pytest.skip(f"{runtime} or onnx is not installed (kinemap[cpu])")
    dense, exact = _dense(network, way), TorchDense(network)
    rng = np.random.default_rng(5)
    for height, width in SIZES:
        pixels = rng.normal(size=(1, 3, height, width)).astype(np.float32)
        first, again, expected = (_tensors(run(pixels)) for run in (dense, dense, exact))
        assert [tensor.shape for tensor in first] == [tensor.shape for tensor in expected]
        for ours, repeated, theirs in zip(first, again, expected, strict=True):
            torch.testing.assert_close(ours, theirs, atol=1e-4, rtol=1e-4)
            assert torch.equal(ours, repeated)


def test_a_network_is_exported_once_for_a_size(network: SoloV2, cache: Path) -> None:
    pytest.importorskip("onnx", reason="onnx is not installed (kinemap[cpu])")
    first = Exporter(network).onnx(64, 96)
    kept = {path: path.stat().st_mtime_ns for path in exports_folder().iterdir()}
    assert Exporter(network).onnx(64, 96) == first
    assert {path: path.stat().st_mtime_ns for path in exports_folder().iterdir()} == kept
    assert exports_folder().is_relative_to(cache)
    torch.manual_seed(4)
    other = folded(SoloV2(VARIANTS["solov2-compact_lite0"], 3).eval())
    assert Exporter(other).onnx(64, 96) != first


def test_every_way_there_is_segments(network: SoloV2) -> None:
    runs = NetworkRuns(network, (96, 64), torch.device("cpu"), threads=1)
    image = np.random.default_rng(1).integers(0, 255, (64, 96, 3), np.uint8)
    counts = {}
    for way in runs.ways:
        if way.precision == "fp32":
            counts[way] = len(runs.inference(way, 0.0).segment(image).scores)
    assert len(counts) == 1 + len(EXACT_WAYS)
    assert len(set(counts.values())) == 1
