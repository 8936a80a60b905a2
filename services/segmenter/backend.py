# SPDX-License-Identifier: Apache-2.0
"""What every way of finding instances is to the segmenter service."""

from collections.abc import Collection
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
import numpy.typing as npt

from schemas.records import Image, Instance, Instances, TrueInstances


@dataclass(frozen=True)
class FrameContext:
    """What is known of a frame besides its image; a network needs none of it."""

    frame_name: str
    """the image's name in its source"""
    true_instances: TrueInstances | None = None
    """from the simulator"""


class InstanceBackend(Protocol):
    """Finds the potentially dynamic objects of one image, without memory of the images before."""

    missing_frames: int
    """frames so far that there was no word about although there should have been"""

    def segment(self, image: Image, context: FrameContext) -> Instances:
        """The instances, each with at least one pixel, under the image's timestamp; `skipped` when there is no word.

        Raises:
            InputError: what the backend reads cannot be used.
        """

    def close(self) -> None:
        """Let go of files and devices."""


def skipped_frame(image: Image) -> Instances:
    """The word that this frame was not segmented."""
    return Instances(image.timestamp_ns, np.zeros(image.pixels.shape[:2], dtype=np.uint32), (), skipped=True)


@dataclass(frozen=True)
class Candidate:
    """An instance before it is chosen: its pixel value in the label image, what it is, and how sure that is."""

    label: int
    category: str
    score: float


@dataclass(frozen=True)
class InstanceFilter:
    """Chooses the potentially dynamic ones."""

    categories: Collection[str]
    min_score: float = 0.0

    def takes(self, candidate: Candidate) -> bool:
        """Whether it is of these categories and sure enough."""
        # Scores travel as 32 bits: one that is on the edge must fall on the same side when it was recorded.
        return candidate.category in self.categories and bool(np.float32(candidate.score) >= np.float32(self.min_score))

    def choose(
        self, timestamp_ns: int, labels: npt.NDArray[np.unsignedinteger], candidates: Collection[Candidate]
    ) -> Instances:
        """The chosen instances that have pixels, with their boxes; all other pixels become background.

        Args:
            timestamp_ns: the image's capture time.
            labels: (H, W), 0 = background, else a candidate's label.
            candidates: each label at most once, none of them 0.
        """
        shown = np.zeros(labels.shape, dtype=np.uint32)
        kept = []
        for candidate in candidates:
            if not self.takes(candidate):
                continue
            mask = labels == candidate.label
            x, y, width, height = cv2.boundingRect(mask.view(np.uint8))
            if width == 0:
                continue
            box = np.s_[y : y + height, x : x + width]
            shown[box][mask[box]] = candidate.label
            box_px = (float(x), float(y), float(width), float(height))
            kept.append(Instance(candidate.label, candidate.category, candidate.score, box_px))
        return Instances(timestamp_ns, shown, tuple(kept))
