# SPDX-License-Identifier: Apache-2.0
"""A network in torch, on a processor or a GPU."""

from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import torch

from services.segmenter.runtimes.way import Precision
from services.segmenter.solov2.head import HeadOutput
from services.segmenter.solov2.network import SoloV2


@dataclass(frozen=True)
class TorchOptions:
    """How a network is run."""

    device: torch.device
    precision: Precision = "fp32"


def autocast(options: TorchOptions) -> AbstractContextManager[Any]:
    """Where products are computed in the numbers that are asked for."""
    dtype = {"fp32": torch.float32, "bf16": torch.bfloat16, "fp16": torch.float16}[options.precision]
    return torch.autocast(options.device.type, dtype, enabled=dtype != torch.float32)


class TorchDense:
    """Runs a network, in evaluation mode. Nothing but the network itself is computed in fewer than 32 bits."""

    def __init__(self, network: SoloV2, options: TorchOptions | None = None) -> None:
        self._options = options or TorchOptions(next(network.parameters()).device)
        self._network = network.to(self._options.device).to(memory_format=torch.channels_last)  # type: ignore[call-overload]

    def __call__(self, pixels: npt.NDArray[np.float32]) -> HeadOutput:
        """See Dense; the output lies on the network's device."""
        images = torch.from_numpy(pixels).to(self._options.device).contiguous(memory_format=torch.channels_last)
        with torch.inference_mode(), autocast(self._options):
            output: HeadOutput = self._network(images)
        kernels, categories = (tuple(level.float() for level in part) for part in (output.kernels, output.categories))
        return HeadOutput(kernels, categories, output.mask_features.float())
