# SPDX-License-Identifier: Apache-2.0
import pytest
import torch
from torch import nn

from services.segmenter.solov2.folding import folded
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import VARIANTS


@pytest.mark.parametrize("name", ["solov2-compact_lite0", "solov2-light_r50"])
def test_a_folded_network_says_the_same(name: str) -> None:
    torch.manual_seed(0)
    network = SoloV2(VARIANTS[name], 3).eval()
    for module in network.modules():
        if isinstance(module, nn.BatchNorm2d):
            nn.init.uniform_(module.running_mean, -1, 1)
            nn.init.uniform_(module.running_var, 0.5, 2)
            nn.init.uniform_(module.weight, 0.5, 1.5)
            nn.init.uniform_(module.bias, -1, 1)
    images = torch.randn(1, 3, 64, 96)
    with torch.inference_mode():
        one, two = network(images), folded(network)(images)
    assert not any(isinstance(module, nn.BatchNorm2d) for module in folded(network).modules())
    assert any(isinstance(module, nn.BatchNorm2d) for module in network.modules())
    scale = one.mask_features.abs().mean()
    assert torch.allclose(one.mask_features, two.mask_features, atol=1e-3 * float(scale), rtol=1e-3)
    for first, second in zip(one.categories + one.kernels, two.categories + two.kernels, strict=True):
        assert torch.allclose(first, second, atol=1e-3, rtol=1e-3)
