# SPDX-License-Identifier: Apache-2.0
"""Backend `solov2`: a network finds the instances."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt

from schemas.records import Image, Instances
from services.segmenter.backend import Candidate, FrameContext, InstanceFilter
from services.segmenter.solov2.instances import SegmentedInstances


class Inference(Protocol):
    """Runs a network in one of the runtimes."""

    def segment(self, image: npt.NDArray[np.uint8]) -> SegmentedInstances:
        """The instances of an image, (H, W, 3) BGR or (H, W) grey, surest first."""


class NetworkInstances:
    """Gives each pixel to the surest instance that has it; an instance's id is its rank among those that are chosen.

    Args:
        inference: the network.
        categories: names, in the order of the network's outputs.
        chosen: which instances are kept. What is not kept hides nothing.
    """

    def __init__(self, inference: Inference, categories: Sequence[str], chosen: InstanceFilter) -> None:
        self._inference = inference
        self._categories = categories
        self._filter = chosen
        self.missing_frames = 0

    def segment(self, image: Image, context: FrameContext) -> Instances:
        found = self._inference.segment(image.pixels)
        labels = np.zeros(image.pixels.shape[:2], np.uint16)
        candidates: list[Candidate] = []
        rows = zip(found.masks.cpu().numpy(), found.labels.tolist(), found.scores.tolist(), strict=True)
        for mask, label, score in rows:
            candidate = Candidate(len(candidates) + 1, self._categories[label], score)
            if self._filter.takes(candidate):
                labels[mask & (labels == 0)] = candidate.label
                candidates.append(candidate)
        return self._filter.choose(image.timestamp_ns, labels, candidates)

    def close(self) -> None:
        """Nothing is held open."""
