# SPDX-License-Identifier: Apache-2.0
"""One image through a network of ours, in torch."""

from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor

from services.segmenter.processor import multiplies_bfloat16
from services.segmenter.solov2.head import HeadOutput
from services.segmenter.solov2.instances import InstanceOptions, SegmentedInstances, instances_of
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.preprocessing import prepare

Precision = Literal["fp32", "bf16", "fp16"]


def precisions(device: torch.device) -> tuple[Precision, ...]:
    """What there is to choose from on a device, the exact one first."""
    if device.type == "cuda":
        return ("fp32", "fp16")
    return ("fp32", "bf16") if multiplies_bfloat16() else ("fp32",)


@dataclass(frozen=True)
class TorchOptions:
    """How a network is run."""

    device: torch.device
    precision: Precision = "fp32"


def autocast(runtime: TorchOptions) -> AbstractContextManager[Any]:
    """Where products are computed in the numbers that are asked for."""
    dtype = {"fp32": torch.float32, "bf16": torch.bfloat16, "fp16": torch.float16}[runtime.precision]
    return torch.autocast(runtime.device.type, dtype, enabled=dtype != torch.float32)


class TorchInference:
    """Runs a network, in evaluation mode. Nothing but the network itself is computed in fewer than 32 bits."""

    def __init__(
        self,
        network: SoloV2,
        input_box: tuple[int, int],
        options: InstanceOptions | None = None,
        runtime: TorchOptions | None = None,
    ) -> None:
        self._runtime = runtime or TorchOptions(next(network.parameters()).device)
        self._network = network.to(self._runtime.device).to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        self._box = input_box
        self._options = replace(options or InstanceOptions(), least_area=network.variant.least_area)

    def segment(self, image: npt.NDArray[np.uint8]) -> SegmentedInstances:
        """The instances of an image, (H, W, 3) BGR or (H, W) grey, on the network's device."""
        given = prepare(image, self._box)
        with torch.inference_mode():
            output = self._run(torch.from_numpy(given.pixels).to(self._runtime.device))
            return instances_of(output, given.resized_hw, given.original_hw, self._options)

    def _run(self, images: Tensor) -> HeadOutput:
        with autocast(self._runtime):
            output: HeadOutput = self._network(images.contiguous(memory_format=torch.channels_last))
        kernels, categories = (tuple(level.float() for level in part) for part in (output.kernels, output.categories))
        return HeadOutput(kernels, categories, output.mask_features.float())
