# SPDX-License-Identifier: Apache-2.0
"""A network in OpenVINO, on a processor."""

import numpy as np
import numpy.typing as npt
import openvino
import torch

from services.segmenter.runtimes.compiled_sizes import CompiledSizes
from services.segmenter.runtimes.export import Exporter, head_output
from services.segmenter.runtimes.way import Precision
from services.segmenter.solov2.head import HeadOutput


class OpenVinoDense:
    """Reads the network as ONNX: OpenVINO's own conversion from torch wants to report its use to its makers.

    Args:
        exporter: of the network.
        precision: of products; sums, inputs and outputs have 32 bits.
        threads: at most so many.
    """

    def __init__(self, exporter: Exporter, precision: Precision, threads: int) -> None:
        self._core = openvino.Core()
        self._properties = {
            "INFERENCE_PRECISION_HINT": {"fp32": "f32", "bf16": "bf16", "fp16": "f16"}[precision],
            "INFERENCE_NUM_THREADS": threads,
            "NUM_STREAMS": 1,
            # the other services run on these cores too
            "ENABLE_CPU_PINNING": False,
        }
        self._exporter = exporter
        self._requests = CompiledSizes(self._compile)

    def __call__(self, pixels: npt.NDArray[np.float32]) -> HeadOutput:
        """See Dense."""
        request = self._requests.of(*pixels.shape[2:])
        request.infer([pixels], share_inputs=True, share_outputs=True)
        return head_output([torch.from_numpy(tensor.data) for tensor in request.output_tensors])

    def _compile(self, height: int, width: int) -> openvino.InferRequest:
        model = self._core.read_model(self._exporter.onnx(height, width))
        return self._core.compile_model(model, "CPU", self._properties).create_infer_request()
