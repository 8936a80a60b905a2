# SPDX-License-Identifier: Apache-2.0
"""One image through a network of ours, in torch."""

import numpy as np
import numpy.typing as npt
import torch

from services.segmenter.solov2.instances import InstanceOptions, SegmentedInstances, instances_of
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.preprocessing import prepare


class TorchInference:
    """Runs a network, in evaluation mode, where it is."""

    def __init__(self, network: SoloV2, input_box: tuple[int, int], options: InstanceOptions | None = None) -> None:
        self._network = network
        self._box = input_box
        self._options = options or InstanceOptions()

    def segment(self, image: npt.NDArray[np.uint8]) -> SegmentedInstances:
        """The instances of an image, (H, W, 3) BGR or (H, W) grey, on the network's device."""
        given = prepare(image, self._box)
        device = next(self._network.parameters()).device
        with torch.inference_mode():
            output = self._network(torch.from_numpy(given.pixels).to(device))
            return instances_of(output, given.resized_hw, given.original_hw, self._options)
