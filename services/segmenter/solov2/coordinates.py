# SPDX-License-Identifier: Apache-2.0
"""CoordConv (Liu et al., NeurIPS 2018): convolutions see where they are."""

import torch
from torch import Tensor


def with_coordinates(features: Tensor) -> Tensor:
    """(N, C, H, W) to (N, C + 2, H, W): x and y, from -1 at the first column or row to 1 at the last, come last."""
    count, _, height, width = features.shape
    x = torch.linspace(-1, 1, width, dtype=features.dtype, device=features.device)
    y = torch.linspace(-1, 1, height, dtype=features.dtype, device=features.device)
    x = x.view(1, 1, 1, width).expand(count, 1, height, width)
    y = y.view(1, 1, height, 1).expand(count, 1, height, width)
    return torch.cat([features, x, y], dim=1)
