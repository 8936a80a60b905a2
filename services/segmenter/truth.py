# SPDX-License-Identifier: Apache-2.0
"""Backend `truth`: the simulator's own instances, as a perfect network would give them."""

from schemas.records import Image, Instances
from services.runtime.errors import InputError
from services.segmenter.backend import Candidate, FrameContext, InstanceFilter, skipped_frame


class TrueLabels:
    """Passes on what the simulator knows of the image: where objects are and what they are, never whether they move.

    A frame without truth is skipped and counted.
    """

    def __init__(self, chosen: InstanceFilter) -> None:
        self._filter = chosen
        self.missing_frames = 0

    def segment(self, image: Image, context: FrameContext) -> Instances:
        truth = context.true_instances
        if truth is None:
            self.missing_frames += 1
            return skipped_frame(image)
        if truth.labels.shape != image.pixels.shape[:2]:
            raise InputError(
                f"true labels of frame {context.frame_name}: {truth.labels.shape[1]}x{truth.labels.shape[0]} px, "
                f"expected {image.pixels.shape[1]}x{image.pixels.shape[0]} as its image"
            )
        candidates = [Candidate(item.instance_id, item.category, 1.0) for item in truth.objects]
        return self._filter.choose(image.timestamp_ns, truth.labels, candidates)

    def close(self) -> None:
        """Nothing is held open."""
