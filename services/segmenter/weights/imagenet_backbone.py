# SPDX-License-Identifier: Apache-2.0
"""Reads backbones that were learned at ImageNet: torchvision's ResNets and EfficientNet-Lite0 in torch."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import torch
from torch import Tensor

from services.runtime.errors import InputError
from services.segmenter.solov2.backbones import BACKBONES
from services.segmenter.solov2.efficientnet_lite import EfficientNetLite
from services.segmenter.solov2.preprocessing import MEAN_RGB, STD_RGB
from services.weights.torch_file import load_torch_file

_CLASSIFIER: Final = re.compile(r"(fc|_fc|_conv_head|_bn1)\.")
_BLOCK_PARTS: Final = (
    ("_expand_conv", "expand.conv"),
    ("_bn0", "expand.norm"),
    ("_depthwise_conv", "depthwise.conv"),
    ("_bn1", "depthwise.norm"),
    ("_project_conv", "project.conv"),
    ("_bn2", "project.norm"),
)
_GREY, _HALF_RANGE = 127.0, 128.0
"""EfficientNet-Lite takes (value - grey) / half range"""


def read_backbone(path: Path, name: str) -> dict[str, Tensor]:
    """The state of backbone `name` (of BACKBONES) out of a classifier's .pth file.

    Raises:
        InputError: it is no such file, holds more than tensors, or they are another network's.
    """
    content = load_torch_file(path, f"the weights of {name}")
    if not isinstance(content, dict) or not all(isinstance(value, Tensor) for value in content.values()):
        raise InputError(f"{path}: holds no tensors by name, expected the weights of {name}")
    state = {key: value for key, value in content.items() if not _CLASSIFIER.match(key)}
    with torch.device("meta"):
        backbone = BACKBONES[name]()
    if isinstance(backbone, EfficientNetLite):
        state = _renormalized(_renamed(state, backbone.blocks_of_stages))
    expected = {key: tuple(value.shape) for key, value in backbone.state_dict().items()}
    found = {key: tuple(value.shape) for key, value in state.items()}
    if found != expected:
        differing = sorted(key for key in found.keys() | expected.keys() if found.get(key) != expected.get(key))
        raise InputError(f"{path}: its tensors are not those of {name} ({differing[0]} and {len(differing) - 1} more)")
    return state


def _renamed(state: Mapping[str, Tensor], blocks_of: tuple[int, ...]) -> dict[str, Tensor]:
    """From the names of efficientnet_lite_pytorch, where blocks are numbered through, to those here."""
    places = [f"stages.{stage}.{block}" for stage, count in enumerate(blocks_of) for block in range(count)]
    prefixes = {"_conv_stem": "stem.conv", "_bn0": "stem.norm"}
    for number, place in enumerate(places):
        prefixes |= {f"_blocks.{number}.{theirs}": f"{place}.{ours}" for theirs, ours in _BLOCK_PARTS}
    renamed = {}
    for key, value in state.items():
        prefix, _, suffix = key.rpartition(".")
        renamed[f"{prefixes.get(prefix, prefix)}.{suffix}"] = value
    return renamed


def _renormalized(state: dict[str, Tensor]) -> dict[str, Tensor]:
    """For images normalised as preprocessing.py does it: the stem's filters scaled, its mean shifted."""
    weight, mean = state.get("stem.conv.weight"), state.get("stem.norm.running_mean")
    if weight is None or mean is None or weight.ndim != 4 or weight.shape[1] != len(STD_RGB):
        return state
    scale = torch.from_numpy(STD_RGB / _HALF_RANGE).view(1, -1, 1, 1)
    shift = torch.from_numpy((MEAN_RGB - _GREY) / _HALF_RANGE).view(1, -1, 1, 1)
    return {
        **state,
        "stem.conv.weight": weight * scale,
        "stem.norm.running_mean": mean - (weight * shift).sum((1, 2, 3)),
    }
