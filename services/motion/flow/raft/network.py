# SPDX-License-Identifier: Apache-2.0
"""The whole network."""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from services.motion.flow.raft.correlation import CorrelationPyramid
from services.motion.flow.raft.encoder import Encoder
from services.motion.flow.raft.update_block import UpdateBlock
from services.motion.flow.raft.upsampling import bilinear, convex
from services.motion.flow.raft.variants import Variant

_GREY = 127.5
_WEIGHT_SCALE = 0.25
"""of the upsampling's weights, which balanced their gradients with the flow's in training"""


class RaftFlow(NamedTuple):
    """From the first image to the second, px of the input and elements of 8 px."""

    flow: Tensor
    """(N, 2, H, W) px"""
    coarse: Tensor
    """(N, 2, H / 8, W / 8) elements"""


class Raft(nn.Module):
    """Recurrent all-pairs field transforms."""

    def __init__(self, variant: Variant) -> None:
        super().__init__()
        self.variant = variant
        self.fnet = Encoder(variant, "instance", variant.feature_channels)
        self.cnet = Encoder(variant, variant.context_norm, variant.hidden_channels + variant.context_channels)
        self.update_block = UpdateBlock(variant)

    def forward(self, first: Tensor, second: Tensor, iterations: int = 12, begin: Tensor | None = None) -> RaftFlow:
        """The flow between two batches of images.

        Args:
            first, second: (N, 3, H, W) RGB, 0 to 255; H and W multiples of 8.
            iterations: corrections of the flow, each as costly as the one before.
            begin: (N, 2, H / 8, W / 8) elements to begin with, zero when not given.
        """
        first, second = first / _GREY - 1, second / _GREY - 1
        features = self.fnet(torch.cat([first, second]))
        of_first, of_second = features.chunk(2)
        correlations = CorrelationPyramid(of_first, of_second, self.variant.radius)
        context = self.cnet(first)
        hidden, inputs = context.split([self.variant.hidden_channels, self.variant.context_channels], dim=1)
        hidden, inputs = hidden.tanh(), inputs.relu()
        places = _places(of_first)
        flow = torch.zeros_like(places) if begin is None else begin
        for _ in range(iterations):
            hidden, change = self.update_block(hidden, inputs, correlations.around(places + flow), flow)
            flow = flow + change
        return RaftFlow(self._enlarged(flow, hidden), flow)

    def _enlarged(self, flow: Tensor, hidden: Tensor) -> Tensor:
        if self.update_block.mask is None:
            return bilinear(flow)
        return convex(flow, _WEIGHT_SCALE * self.update_block.mask(hidden))


def _places(features: Tensor) -> Tensor:
    """x and y of each element, (N, 2, H, W)."""
    count, _, height, width = features.shape
    y, x = torch.meshgrid(
        torch.arange(height, dtype=features.dtype, device=features.device),
        torch.arange(width, dtype=features.dtype, device=features.device),
        indexing="ij",
    )
    return torch.stack([x, y]).expand(count, 2, height, width)
