# SPDX-License-Identifier: Apache-2.0
"""A network as ONNX, for the libraries that are not torch; made once, then taken from the cache."""

import hashlib
import warnings
from functools import cached_property
from pathlib import Path
from typing import Final

import torch
from torch import Tensor, nn

from services.segmenter.runtimes.export_cache import cached_bytes
from services.segmenter.solov2.head import HeadOutput
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import GRIDS

_OPSET: Final = 17
_FORMAT: Final = 1
"""to be raised when the network's code changes what it computes of the same weights"""
_LEVELS: Final = len(GRIDS)
INPUT_NAME: Final = "images"
_OUTPUT_NAMES: Final = (
    *(f"kernels{level}" for level in range(_LEVELS)),
    *(f"categories{level}" for level in range(_LEVELS)),
    "mask_features",
)


class Exporter:
    """Exports a network in 32 bits, for one size of input at a time: its grids and coordinates become constants."""

    def __init__(self, network: SoloV2) -> None:
        self._network = network

    @cached_property
    def _digest(self) -> str:
        """SHA-256 of the weights and of what the network is."""
        digest = hashlib.sha256(repr(self._network.variant).encode())
        for name, value in sorted(self._network.state_dict().items()):
            digest.update(f"{name} {tuple(value.shape)}".encode())
            digest.update(value.detach().cpu().contiguous().numpy())
        return digest.hexdigest()

    def onnx(self, height: int, width: int) -> bytes:
        """The network for images (1, 3, height, width). Raises what torch raises where it cannot be exported."""
        key = f"{self._digest} {height}x{width} opset {_OPSET} format {_FORMAT} torch {torch.__version__}"
        return cached_bytes(key, lambda path: self._write(path, height, width))

    def _write(self, path: Path, height: int, width: int) -> None:
        # on the device and in the layout that the weights are in already
        images = torch.zeros(1, 3, height, width, device=next(self._network.parameters()).device)
        with torch.no_grad(), warnings.catch_warnings():
            # the newer exporter needs one package more and gives the same graph
            warnings.simplefilter("ignore")
            torch.onnx.export(
                _Flat(self._network).eval(),
                (images,),
                path,
                input_names=[INPUT_NAME],
                output_names=_OUTPUT_NAMES,
                opset_version=_OPSET,
                dynamo=False,
            )


def head_output(arrays: list[Tensor]) -> HeadOutput:
    """An exported network's outputs, in their order, as the head's."""
    return HeadOutput(tuple(arrays[:_LEVELS]), tuple(arrays[_LEVELS : 2 * _LEVELS]), arrays[-1])


class _Flat(nn.Module):
    """The network with its outputs in one row, as graphs have them."""

    def __init__(self, network: SoloV2) -> None:
        super().__init__()
        self.network = network

    def forward(self, images: Tensor) -> tuple[Tensor, ...]:
        """(1, 3, H, W) to kernels and categories of each level, then mask features."""
        output: HeadOutput = self.network(images)
        return (*output.kernels, *output.categories, output.mask_features)
