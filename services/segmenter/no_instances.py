# SPDX-License-Identifier: Apache-2.0
"""Backend `none`: no word about any frame."""

from schemas.records import Image, Instances
from services.segmenter.backend import FrameContext, skipped_frame


class NoInstances:
    """Skips every frame; what follows carries on as with a segmenter that is too slow."""

    missing_frames = 0

    def segment(self, image: Image, context: FrameContext) -> Instances:
        return skipped_frame(image)

    def close(self) -> None:
        """Nothing is held open."""
