# SPDX-License-Identifier: Apache-2.0
"""One image through SOLOv2."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import torch

from services.segmenter.runtimes.dense import Dense
from services.segmenter.solov2.instances import InstanceOptions, SegmentedInstances, instances_of
from services.segmenter.solov2.preprocessing import prepare
from services.segmenter.solov2.variants import Variant


class SoloInference:
    """Segments with what runs the network.

    Args:
        dense: the network, in any of its runtimes.
        variant: which network it is.
        input_box: (width, height) that images are fitted into.
        options: which candidates become instances; the least area is the variant's.
    """

    def __init__(
        self, dense: Dense, variant: Variant, input_box: tuple[int, int], options: InstanceOptions | None = None
    ) -> None:
        self._dense = dense
        self._box = input_box
        self._options = replace(options or InstanceOptions(), least_area=variant.least_area)

    def segment(self, image: npt.NDArray[np.uint8]) -> SegmentedInstances:
        """The instances of an image, (H, W, 3) BGR or (H, W) grey, on the device that runs the network."""
        given = prepare(image, self._box)
        with torch.inference_mode():
            return instances_of(self._dense(given.pixels), given.resized_hw, given.original_hw, self._options)
