# SPDX-License-Identifier: Apache-2.0
"""Batch normalisation folded into the convolutions before it: the same numbers, fewer passes over memory."""

from copy import deepcopy
from typing import Protocol, TypeVar, cast

from torch import nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

from services.segmenter.solov2.backbones import Backbone


class _WithBackbone(Protocol):
    backbone: Backbone


Network = TypeVar("Network", bound=nn.Module)

_PAIRS = (("conv1", "bn1"), ("conv2", "bn2"), ("conv3", "bn3"), ("0", "1"), ("conv", "norm"))
"""names of a convolution and what normalises its output: in a residual block, the stem and a shortcut of ResNet; in
EfficientNet"""


def folded(network: Network) -> Network:
    """A copy of a network in evaluation mode, for use only: it has no batch normalisation left."""
    copy = deepcopy(network).eval()
    for module in list(cast(_WithBackbone, copy).backbone.modules()):
        for conv_name, norm_name in _PAIRS:
            conv, norm = (module._modules.get(name) for name in (conv_name, norm_name))
            if isinstance(conv, nn.Conv2d) and isinstance(norm, nn.BatchNorm2d):
                module._modules[conv_name] = fuse_conv_bn_eval(conv, norm)
                module._modules[norm_name] = nn.Identity()
    return copy
