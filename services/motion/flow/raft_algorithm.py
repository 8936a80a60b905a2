# SPDX-License-Identifier: Apache-2.0
"""RAFT as a way of computing dense flow."""

import cv2
import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor
from torch.nn.functional import pad

from services.motion.flow.algorithm import Pixels
from services.motion.flow.raft.network import Raft
from services.motion.flow.raft.variants import LEVELS, STRIDE

_LEAST_PX = STRIDE * 2**LEVELS
"""smaller images have nothing left on the correlation pyramid's coarsest level"""


class RaftAlgorithm:
    """A network with its weights, on its device."""

    takes_colour = True

    def __init__(self, network: Raft, device: torch.device, iterations: int) -> None:
        self._network = network.to(device)
        self._device = device
        self._iterations = iterations

    @torch.inference_mode()
    def flow(self, start: Pixels, end: Pixels) -> npt.NDArray[np.float32]:
        height, width = start.shape[:2]
        found = self._network(self._input(start), self._input(end), self._iterations).flow[0, :, :height, :width]
        return np.ascontiguousarray(found.permute(1, 2, 0).cpu().numpy())

    def _input(self, pixels: Pixels) -> Tensor:
        """(1, 3, H, W) RGB, the last row and column repeated up to a size that the network takes."""
        rgb = cv2.cvtColor(pixels, cv2.COLOR_GRAY2RGB if pixels.ndim == 2 else cv2.COLOR_BGR2RGB)
        image = torch.from_numpy(rgb).to(self._device, torch.float32).permute(2, 0, 1)[None]
        height, width = image.shape[-2:]
        return pad(image, (0, _padded(width) - width, 0, _padded(height) - height), mode="replicate")


def _padded(size_px: int) -> int:
    return max(_LEAST_PX, -(-size_px // STRIDE) * STRIDE)
