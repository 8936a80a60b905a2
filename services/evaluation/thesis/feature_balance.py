# SPDX-License-Identifier: Apache-2.0
"""How features lie left and right when objects' features are left out (thesis 5.2.1.2 and figure 5.17)."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

import cv2
import numpy as np
import numpy.typing as npt

from schemas.records import MotionState

# The engine's own: the lower threshold it looks at cells with in which there is no corner, and the side of these cells.
_FAST_THRESHOLD = 7
_CELL_PX = 35
_ALL_CORNERS = 200_000
_STANDING = (MotionState.NON_MOVING, MotionState.STATIC)


class Kept(StrEnum):
    """Which features are left for tracking."""

    ALL = "all features"
    WITHOUT_DYNAMIC = "without potentially dynamic objects"
    WITHOUT_MOVING = "without moving objects"


@dataclass(frozen=True)
class SeenObject:
    """One object in one image: its value in the label image, and its motion state; None where nobody knows it."""

    label: int
    category: str
    state: MotionState | None = None


@dataclass(frozen=True)
class LabelledImage:
    """`pixels` (H, W) grey or (H, W, 3) blue-green-red; `labels` (H, W), 0 where there is no object."""

    name: str
    pixels: npt.NDArray[np.uint8]
    labels: npt.NDArray[np.unsignedinteger]
    objects: tuple[SeenObject, ...]


@dataclass(frozen=True)
class Halves:
    """Features in the left and in the right half of one image."""

    left: int
    right: int

    @property
    def skew(self) -> float | None:
        """(right - left) / (right + left): -1 all on the left, 1 all on the right, None without a feature."""
        return (self.right - self.left) / (self.right + self.left) if self.left + self.right else None


@dataclass(frozen=True)
class FrameBalance:
    """One image's features by what is kept; WITHOUT_MOVING is missing where the state of an object is not known."""

    name: str
    halves: dict[Kept, Halves]
    observations: Counter[tuple[str, MotionState | None]]
    """objects by category and state"""


class FeatureBalance:
    """Counts ORB features by image half: OpenCV's ORB with the engine's parameters, spread over the image.

    OpenCV alone keeps the strongest, which a single tree may have all of. Here every cell gives its strongest, then its
    second, and so on until there are `features`: close to what the engine's quadtree does, and to ORB-SLAM's.
    """

    def __init__(self, features: int = 2000, pyramid_levels: int = 8, pyramid_factor: float = 1.2) -> None:
        self._features = features
        self._orb = cv2.ORB.create(
            _ALL_CORNERS, scaleFactor=pyramid_factor, nlevels=pyramid_levels, fastThreshold=_FAST_THRESHOLD
        )

    def measure(self, frame: LabelledImage) -> FrameBalance:
        """Count one image's. As in stage `moving`, what is moving or undecided is left out as moving."""
        pixels = frame.pixels if frame.pixels.ndim == 2 else cv2.cvtColor(frame.pixels, cv2.COLOR_BGR2GRAY)
        points = self._points(np.asarray(pixels, dtype=np.uint8))
        height, width = frame.labels.shape
        columns = np.clip(np.rint(points[:, 0]).astype(int), 0, width - 1)
        rows = np.clip(np.rint(points[:, 1]).astype(int), 0, height - 1)
        labels = frame.labels[rows, columns]
        right = points[:, 0] > (width - 1) / 2
        halves = {
            Kept.ALL: _halves(right, np.ones(len(points), dtype=bool)),
            Kept.WITHOUT_DYNAMIC: _halves(right, ~np.isin(labels, [item.label for item in frame.objects])),
        }
        if all(item.state is not None for item in frame.objects):
            moving = [item.label for item in frame.objects if item.state not in _STANDING]
            halves[Kept.WITHOUT_MOVING] = _halves(right, ~np.isin(labels, moving))
        return FrameBalance(frame.name, halves, Counter((item.category, item.state) for item in frame.objects))

    def _points(self, pixels: npt.NDArray[np.uint8]) -> npt.NDArray[np.float64]:
        found = self._orb.detect(pixels, None)
        points = np.array([point.pt for point in found], dtype=np.float64).reshape(-1, 2)
        strength = np.array([point.response for point in found])
        columns, rows = (points // _CELL_PX).astype(int).T
        cells = rows * (pixels.shape[1] // _CELL_PX + 1) + columns
        order = np.lexsort((-strength, cells))
        first = np.flatnonzero(np.diff(cells[order], prepend=-1))
        rank = np.arange(len(order)) - np.repeat(first, np.diff(first, append=len(order)))
        chosen = np.lexsort((-strength[order], rank))[: self._features]
        return points[order[chosen]]


@dataclass(frozen=True)
class SequenceBalance:
    """All frames of one sequence; `without_masks` counts those of which nobody said what is in them."""

    name: str
    frames: tuple[FrameBalance, ...]
    without_masks: int = 0

    def skews(self, kept: Kept) -> npt.NDArray[np.float64]:
        """Of every frame that has features of this kind."""
        known = [frame.halves[kept].skew for frame in self.frames if kept in frame.halves]
        return np.array([skew for skew in known if skew is not None])

    def knows(self, kept: Kept) -> bool:
        """Whether every frame says what is left of this kind: else the frames would not be the same ones."""
        return bool(self.frames) and all(kept in frame.halves for frame in self.frames)

    def mean_features(self, kept: Kept) -> float | None:
        """A frame; None where it is not known."""
        if not self.knows(kept):
            return None
        return float(np.mean([frame.halves[kept].left + frame.halves[kept].right for frame in self.frames]))

    def observations(self, states: Iterable[MotionState | None], category: str | None = None) -> int:
        """Objects of all frames in one of these states, of one category or of all."""
        wanted = set(states)
        return sum(
            count
            for frame in self.frames
            for (name, state), count in frame.observations.items()
            if state in wanted and category in (None, name)
        )

    def parked_share(self, category: str | None = None) -> float | None:
        """Of the objects whose state is decided those that stand; None without one."""
        standing = self.observations(_STANDING, category)
        moving = self.observations((MotionState.MOVING,), category)
        return standing / (standing + moving) if standing + moving else None


def _halves(right: npt.NDArray[np.bool_], kept: npt.NDArray[np.bool_]) -> Halves:
    return Halves(int(np.sum(kept & ~right)), int(np.sum(kept & right)))
