# SPDX-License-Identifier: Apache-2.0
"""One image through Mask R-CNN, in torch."""

import numpy as np
import numpy.typing as npt
import torch

from services.segmenter.mask_rcnn.network import DetectionOptions, MaskRcnn
from services.segmenter.runtimes.torch_dense import TorchOptions, autocast
from services.segmenter.solov2.instances import SegmentedInstances
from services.segmenter.solov2.preprocessing import prepare


class MaskRcnnInference:
    """Runs a network, in evaluation mode; what becomes of boxes and scores is computed in 32 bits."""

    def __init__(
        self, network: MaskRcnn, input_box: tuple[int, int], options: DetectionOptions, runtime: TorchOptions
    ) -> None:
        self._runtime = runtime
        self._network = network.to(runtime.device).to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        self._box = input_box
        self._options = options

    def segment(self, image: npt.NDArray[np.uint8]) -> SegmentedInstances:
        """The instances of an image, (H, W, 3) BGR or (H, W) grey, on the network's device."""
        given = prepare(image, self._box)
        pixels = torch.from_numpy(given.pixels).to(self._runtime.device)
        pixels = pixels.contiguous(memory_format=torch.channels_last)
        with torch.inference_mode(), autocast(self._runtime):
            found: SegmentedInstances = self._network(pixels, given.resized_hw, given.original_hw, self._options)
        return found
