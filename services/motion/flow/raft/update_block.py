# SPDX-License-Identifier: Apache-2.0
"""The recurrent network that corrects the flow step by step (section 3.3 of the paper)."""

import torch
from torch import Tensor, nn
from torch.nn.functional import relu

from services.motion.flow.raft.variants import STRIDE, Variant


class MotionEncoder(nn.Module):
    """From correlations and the flow so far to what they say about motion."""

    def __init__(self, variant: Variant) -> None:
        super().__init__()
        first, *second = variant.correlation_channels
        self.convc1 = nn.Conv2d(variant.correlations, first, 1)
        self.convc2 = nn.Conv2d(first, second[0], 3, padding=1) if second else None
        self.convf1 = nn.Conv2d(2, variant.flow_channels, 7, padding=3)
        self.convf2 = nn.Conv2d(variant.flow_channels, variant.flow_channels // 2, 3, padding=1)
        joined = variant.correlation_channels[-1] + variant.flow_channels // 2
        self.conv = nn.Conv2d(joined, variant.motion_channels, 3, padding=1)

    def forward(self, flow: Tensor, correlations: Tensor) -> Tensor:
        """(N, 2, H, W) and (N, correlations, H, W) to (N, motion channels + 2, H, W): the flow itself comes last."""
        matching = relu(self.convc1(correlations))
        if self.convc2 is not None:
            matching = relu(self.convc2(matching))
        moving = relu(self.convf2(relu(self.convf1(flow))))
        return torch.cat([relu(self.conv(torch.cat([matching, moving], dim=1))), flow], dim=1)


class ConvGru(nn.Module):
    """A gated recurrent unit of 3x3 convolutions."""

    def __init__(self, hidden: int, inputs: int) -> None:
        super().__init__()
        self.convz = nn.Conv2d(hidden + inputs, hidden, 3, padding=1)
        self.convr = nn.Conv2d(hidden + inputs, hidden, 3, padding=1)
        self.convq = nn.Conv2d(hidden + inputs, hidden, 3, padding=1)

    def forward(self, hidden: Tensor, inputs: Tensor) -> Tensor:
        """(N, hidden, H, W) and (N, inputs, H, W) to the next (N, hidden, H, W)."""
        return _gated(hidden, inputs, self.convz, self.convr, self.convq)


class SeparableConvGru(nn.Module):
    """Two gated recurrent units: of convolutions along rows, then along columns."""

    def __init__(self, hidden: int, inputs: int) -> None:
        super().__init__()
        row = {"kernel_size": (1, 5), "padding": (0, 2)}
        column = {"kernel_size": (5, 1), "padding": (2, 0)}
        self.convz1 = nn.Conv2d(hidden + inputs, hidden, **row)  # type: ignore[arg-type]
        self.convr1 = nn.Conv2d(hidden + inputs, hidden, **row)  # type: ignore[arg-type]
        self.convq1 = nn.Conv2d(hidden + inputs, hidden, **row)  # type: ignore[arg-type]
        self.convz2 = nn.Conv2d(hidden + inputs, hidden, **column)  # type: ignore[arg-type]
        self.convr2 = nn.Conv2d(hidden + inputs, hidden, **column)  # type: ignore[arg-type]
        self.convq2 = nn.Conv2d(hidden + inputs, hidden, **column)  # type: ignore[arg-type]

    def forward(self, hidden: Tensor, inputs: Tensor) -> Tensor:
        """(N, hidden, H, W) and (N, inputs, H, W) to the next (N, hidden, H, W)."""
        hidden = _gated(hidden, inputs, self.convz1, self.convr1, self.convq1)
        return _gated(hidden, inputs, self.convz2, self.convr2, self.convq2)


def _gated(hidden: Tensor, inputs: Tensor, update: nn.Conv2d, reset: nn.Conv2d, candidate: nn.Conv2d) -> Tensor:
    both = torch.cat([hidden, inputs], dim=1)
    share = torch.sigmoid(update(both))
    kept = torch.sigmoid(reset(both)) * hidden
    return (1 - share) * hidden + share * torch.tanh(candidate(torch.cat([kept, inputs], dim=1)))


class FlowHead(nn.Module):
    """From the hidden state to what is added to the flow."""

    def __init__(self, hidden: int, channels: int) -> None:
        super().__init__()
        self.conv1 = nn.Conv2d(hidden, channels, 3, padding=1)
        self.conv2 = nn.Conv2d(channels, 2, 3, padding=1)

    def forward(self, hidden: Tensor) -> Tensor:
        """(N, hidden, H, W) to (N, 2, H, W)."""
        change: Tensor = self.conv2(relu(self.conv1(hidden)))
        return change


class UpdateBlock(nn.Module):
    """One step."""

    def __init__(self, variant: Variant) -> None:
        super().__init__()
        inputs = variant.motion_channels + 2 + variant.context_channels
        self.encoder = MotionEncoder(variant)
        gru = SeparableConvGru if variant.learned_upsampling else ConvGru
        self.gru = gru(variant.hidden_channels, inputs)
        self.flow_head = FlowHead(variant.hidden_channels, variant.flow_head_channels)
        self.mask = _upsampling_weights(variant) if variant.learned_upsampling else None

    def forward(self, hidden: Tensor, context: Tensor, correlations: Tensor, flow: Tensor) -> tuple[Tensor, Tensor]:
        """The next hidden state, and the change of the flow (N, 2, H, W)."""
        hidden = self.gru(hidden, torch.cat([context, self.encoder(flow, correlations)], dim=1))
        return hidden, self.flow_head(hidden)


def _upsampling_weights(variant: Variant) -> nn.Sequential:
    """To the weights of 9 neighbours for each of the 8x8 pixels of an element."""
    return nn.Sequential(
        nn.Conv2d(variant.hidden_channels, 256, 3, padding=1), nn.ReLU(inplace=True), nn.Conv2d(256, STRIDE**2 * 9, 1)
    )
