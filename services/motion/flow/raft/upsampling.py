# SPDX-License-Identifier: Apache-2.0
"""From flow of an eighth of the size to that of all pixels."""

from torch import Tensor
from torch.nn.functional import interpolate, unfold

from services.motion.flow.raft.variants import STRIDE


def bilinear(flow: Tensor) -> Tensor:
    """(N, 2, H, W) in elements to (N, 2, 8 H, 8 W) in px; corners stay corners, as the authors have it."""
    size = (flow.shape[-2] * STRIDE, flow.shape[-1] * STRIDE)
    return STRIDE * interpolate(flow, size=size, mode="bilinear", align_corners=True)


def convex(flow: Tensor, weights: Tensor) -> Tensor:
    """Each pixel a convex combination of the 3x3 elements around its own (section 3.3 of the paper).

    Args:
        flow: (N, 2, H, W) in elements.
        weights: (N, 9 * 64, H, W), before the softmax over the nine.

    Returns:
        (N, 2, 8 H, 8 W) in px.
    """
    count, _, height, width = flow.shape
    shares = weights.view(count, 1, 9, STRIDE, STRIDE, height, width).softmax(dim=2)
    neighbours = unfold(STRIDE * flow, 3, padding=1).view(count, 2, 9, 1, 1, height, width)
    fine = (shares * neighbours).sum(dim=2)
    return fine.permute(0, 1, 4, 2, 5, 3).reshape(count, 2, height * STRIDE, width * STRIDE)
