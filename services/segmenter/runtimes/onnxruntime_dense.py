# SPDX-License-Identifier: Apache-2.0
"""A network in ONNX Runtime, on a processor."""

from typing import Final

import numpy as np
import numpy.typing as npt
import onnxruntime
import torch

from services.segmenter.runtimes.compiled_sizes import CompiledSizes
from services.segmenter.runtimes.export import INPUT_NAME, Exporter, head_output
from services.segmenter.solov2.head import HeadOutput

_ERRORS_ONLY: Final = 3


class OnnxRuntimeDense:
    """Runs an exported network in 32 bits with `threads` threads."""

    def __init__(self, exporter: Exporter, threads: int) -> None:
        self._threads = threads
        self._exporter = exporter
        self._sessions = CompiledSizes(self._compile)

    def __call__(self, pixels: npt.NDArray[np.float32]) -> HeadOutput:
        """See Dense."""
        session = self._sessions.of(*pixels.shape[2:])
        return head_output([torch.from_numpy(array) for array in session.run(None, {INPUT_NAME: pixels})])

    def _compile(self, height: int, width: int) -> onnxruntime.InferenceSession:
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = self._threads
        options.inter_op_num_threads = 1
        options.log_severity_level = _ERRORS_ONLY
        # the other services run on these cores too
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        return onnxruntime.InferenceSession(
            self._exporter.onnx(height, width), options, providers=["CPUExecutionProvider"]
        )
