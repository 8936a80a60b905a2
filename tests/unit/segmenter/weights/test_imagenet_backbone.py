# SPDX-License-Identifier: Apache-2.0
"""Backbones learned elsewhere: read by the names of their publishers, and for images normalised as here."""

from pathlib import Path

import pytest
import torch
from torch import Tensor, nn

from services.runtime.errors import InputError
from services.segmenter.solov2.backbones import BACKBONES
from services.segmenter.solov2.efficientnet_lite import EfficientNetLite
from services.segmenter.weights.imagenet_backbone import read_backbone

LITE = "efficientnet-lite0"


def _published_lite(backbone: EfficientNetLite) -> dict[str, Tensor]:
    """The state as efficientnet_lite_pytorch names it, with a classifier."""
    theirs = {
        "expand.conv": "_expand_conv",
        "expand.norm": "_bn0",
        "depthwise.conv": "_depthwise_conv",
        "depthwise.norm": "_bn1",
        "project.conv": "_project_conv",
        "project.norm": "_bn2",
    }
    state = {"_fc.weight": torch.zeros(10, 1280), "_conv_head.weight": torch.zeros(1280, 320, 1, 1)}
    state |= {"_bn1.weight": torch.zeros(1280), "_bn1.running_mean": torch.zeros(1280)}
    names = {"stem.conv": "_conv_stem", "stem.norm": "_bn0"}
    number = 0
    for stage, count in enumerate(backbone.blocks_of_stages):
        for block in range(count):
            names |= {f"stages.{stage}.{block}.{ours}": f"_blocks.{number}.{name}" for ours, name in theirs.items()}
            number += 1
    for key, value in backbone.state_dict().items():
        prefix, _, suffix = key.rpartition(".")
        state[f"{names[prefix]}.{suffix}"] = value
    return state


@pytest.fixture
def lite() -> EfficientNetLite:
    torch.manual_seed(5)
    backbone = EfficientNetLite().eval()
    for module in backbone.modules():
        if isinstance(module, nn.BatchNorm2d):
            nn.init.uniform_(module.running_mean, -0.5, 0.5)
            nn.init.uniform_(module.running_var, 0.5, 2)
    return backbone


def test_efficientnet_sees_the_same_in_images_normalised_in_another_way(lite: EfficientNetLite, tmp_path: Path) -> None:
    path = tmp_path / "lite0.pth"
    torch.save(_published_lite(lite), path)
    read = EfficientNetLite().eval()
    read.load_state_dict(read_backbone(path, LITE))
    levels = torch.randint(0, 256, (1, 3, 64, 64)).float()
    mean, deviation = torch.tensor([123.675, 116.28, 103.53]), torch.tensor([58.395, 57.12, 57.375])
    with torch.inference_mode():
        # as the publisher normalises and as preprocessing.py does; at the border the zeros around differ
        one = lite.stem((levels - 127) / 128)[..., 1:-1, 1:-1]
        two = read.stem((levels - mean.view(3, 1, 1)) / deviation.view(3, 1, 1))[..., 1:-1, 1:-1]
    assert one.max() > 0.5
    assert torch.allclose(one, two, atol=1e-5)
    for key, value in lite.stages.state_dict().items():
        assert torch.equal(value, read.stages.state_dict()[key])


def test_a_resnet_is_read_by_torchvisions_names(tmp_path: Path) -> None:
    state = BACKBONES["resnet18"]().state_dict()
    torch.save({**state, "fc.weight": torch.zeros(1000, 512), "fc.bias": torch.zeros(1000)}, tmp_path / "resnet18.pth")
    read = read_backbone(tmp_path / "resnet18.pth", "resnet18")
    assert read.keys() == state.keys()
    assert all(torch.equal(read[key], state[key]) for key in state)


def test_other_files_are_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "weights.pth"
    with pytest.raises(InputError, match=r"weights\.pth: no such file, expected the weights of resnet18"):
        read_backbone(path, "resnet18")
    torch.save(BACKBONES["resnet34"]().state_dict(), path)
    with pytest.raises(InputError, match=r"weights\.pth: its tensors are not those of resnet18 \(layer1\.2\."):
        read_backbone(path, "resnet18")
    with pytest.raises(InputError, match=r"weights\.pth: its tensors are not those of efficientnet-lite0 \(bn1\."):
        read_backbone(path, LITE)
    torch.save([torch.zeros(1)], path)
    with pytest.raises(InputError, match=r"weights\.pth: holds no tensors by name"):
        read_backbone(path, LITE)
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(InputError, match=r"weights\.pth: not a whole checkpoint"):
        read_backbone(path, LITE)
