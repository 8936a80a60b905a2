# SPDX-License-Identifier: Apache-2.0
"""One network, run in any of the ways there are."""

from functools import cached_property
from typing import cast

import torch

from services.segmenter.inference import SoloInference
from services.segmenter.mask_rcnn.inference import MaskRcnnInference
from services.segmenter.mask_rcnn.network import DetectionOptions, MaskRcnn
from services.segmenter.network_instances import Inference
from services.segmenter.networks import Network
from services.segmenter.runtimes.dense import Dense
from services.segmenter.runtimes.export import Exporter
from services.segmenter.runtimes.torch_dense import TorchDense, TorchOptions
from services.segmenter.runtimes.way import Way, precisions, ways_here
from services.segmenter.solov2.instances import InstanceOptions
from services.segmenter.solov2.network import SoloV2


class NetworkRuns:
    """Makes what runs a network.

    Args:
        network: in evaluation mode.
        input_box: (width, height) that images are fitted into.
        device: where torch runs it; the other libraries run on the processor.
        threads: on a processor; torch has as many as it is set to.
    """

    def __init__(self, network: Network, input_box: tuple[int, int], device: torch.device, threads: int) -> None:
        self._network = network
        self._box = input_box
        self._device = device
        self._threads = threads

    @cached_property
    def ways(self) -> tuple[Way, ...]:
        """All that this machine can run it in, the exact one first; Mask R-CNN in torch alone."""
        if isinstance(self._network, MaskRcnn):
            return tuple(Way("torch", precision) for precision in precisions(self._device.type))
        return ways_here(self._device.type)

    def inference(self, way: Way, min_score: float) -> Inference:
        """What runs it; instances below `min_score` are left out. Mask R-CNN runs in torch whatever the way says."""
        if isinstance(self._network, MaskRcnn):
            options = DetectionOptions(min_score=min_score)
            return MaskRcnnInference(self._network, self._box, options, TorchOptions(self._device, way.precision))
        dense, variant = self._dense(self._network, way), self._network.variant
        return SoloInference(dense, variant, self._box, InstanceOptions(min_score=min_score))

    def _dense(self, network: SoloV2, way: Way) -> Dense:
        # a library is imported only where it is to run
        if way.runtime == "openvino":
            from services.segmenter.runtimes.openvino_dense import OpenVinoDense

            return OpenVinoDense(self._exporter, way.precision, self._threads)
        if way.runtime == "onnxruntime":
            from services.segmenter.runtimes.onnxruntime_dense import OnnxRuntimeDense

            return OnnxRuntimeDense(self._exporter, self._threads)
        return TorchDense(network, TorchOptions(self._device, way.precision))

    @cached_property
    def _exporter(self) -> Exporter:
        return Exporter(cast(SoloV2, self._network))
