# SPDX-License-Identifier: Apache-2.0
"""Where in the image things move, over a data set (thesis figure 5.7), and how much of it is at the centre."""

from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from services.evaluation.moving_masks.iou import MaskClass
from services.evaluation.pictures.figure import new_figure, save_figure
from services.evaluation.run.outcome import Report
from services.runtime.errors import InputError

_GRID = (6, 18)
"""rows and columns of the cells whose entropy is taken"""
_WIDTH_IN = 9.0
_LEAST_HEIGHT_IN, _MOST_HEIGHT_IN = 2.0, 8.0


@dataclass
class HeatMap:
    """How often each pixel moved. Images of other sizes than the first are brought to its size.

    Positions are shares of the image's width and height, 0 at the left and upper edge.
    """

    frames: int = 0
    frames_with_movers: int = 0
    mass: npt.NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0)))
    """(H, W): in how many frames a pixel moved"""

    def add(self, mask: npt.NDArray[np.uint8]) -> None:
        """Take one frame's mask of `MaskClass` (H, W)."""
        moving = (mask == MaskClass.MOVING).astype(np.float32)
        if not self.mass.size:
            self.mass = np.zeros(mask.shape)
        elif mask.shape != self.mass.shape:
            size = self.mass.shape[1], self.mass.shape[0]
            moving = np.asarray(cv2.resize(moving, size, interpolation=cv2.INTER_AREA), dtype=np.float32)
        self.frames += 1
        self.frames_with_movers += bool(moving.any())
        self.mass += moving

    @property
    def total(self) -> float:
        """Moving pixels of all frames."""
        return float(self.mass.sum())

    @property
    def central_third(self) -> float:
        """Share of the mass in the middle third of the columns; 1/3 where movers are everywhere alike."""
        return float(self._middle(self.mass).sum()) / self.total

    @property
    def central_ninth(self) -> float:
        """Share of the mass in the middle third of both rows and columns; 1/9 where movers are everywhere alike."""
        return float(self._middle(self._middle(self.mass).T).sum()) / self.total

    @property
    def entropy(self) -> float:
        """Of the mass over 6 x 18 cells, as a share of the largest: 1 where it is even, 0 where all is in one cell."""
        cells = cv2.resize(self.mass, _GRID[::-1], interpolation=cv2.INTER_AREA).ravel()
        share = cells[cells > 0.0] / cells.sum()
        return float(-(share * np.log(share)).sum() / np.log(_GRID[0] * _GRID[1])) + 0.0

    @property
    def mean_position(self) -> tuple[float, float]:
        """x and y of the centre of mass."""
        return self._moments(0)[0], self._moments(1)[0]

    @property
    def spread(self) -> tuple[float, float]:
        """Standard deviation of the mass in x and y."""
        return self._moments(0)[1], self._moments(1)[1]

    def describe(self) -> Report:
        """The numbers for JSON. Raises InputError where nothing moves in any frame."""
        if not self.total:
            raise InputError(f"nothing moves in {self.frames} masks, expected a moving pixel")
        return {
            "frames": self.frames,
            "frames_with_movers": self.frames_with_movers,
            "moving_share_of_pixels": self.total / (self.frames * self.mass.size),
            "central_third": self.central_third,
            "central_ninth": self.central_ninth,
            "entropy": self.entropy,
            "mean_position": dict(zip("xy", self.mean_position, strict=True)),
            "spread": dict(zip("xy", self.spread, strict=True)),
            "width": self.mass.shape[1],
            "height": self.mass.shape[0],
        }

    def _moments(self, axis: int) -> tuple[float, float]:
        profile = self.mass.sum(axis=axis) / self.total
        place = (np.arange(profile.size) + 0.5) / profile.size
        mean = float(profile @ place)
        return mean, float(np.sqrt(profile @ (place - mean) ** 2))

    @staticmethod
    def _middle(mass: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        third = mass.shape[1] / 3.0
        # the columns that the thirds' edges cut are shared between them
        edges = np.arange(mass.shape[1])
        weight: npt.NDArray[np.float64] = np.clip(np.minimum(edges + 1, 2 * third) - np.maximum(edges, third), 0.0, 1.0)
        return np.asarray(mass * weight)


def plot_heat_map(heat: HeatMap, path: Path, title: str = "") -> None:
    """The share of the frames in which each pixel moves; dotted are the thirds, the cross is the centre of mass."""
    height, width = heat.mass.shape
    height_in = float(np.clip(0.4 + 0.88 * _WIDTH_IN * height / width, _LEAST_HEIGHT_IN, _MOST_HEIGHT_IN))
    figure = new_figure(height_in=height_in, width_in=_WIDTH_IN)
    axes = figure.add_subplot()
    shown = axes.imshow(100.0 * heat.mass / heat.frames, cmap="inferno", vmin=0.0, interpolation="nearest")
    for part in (1 / 3, 2 / 3):
        axes.axvline(part * width - 0.5, color="white", linewidth=0.8, linestyle=":")
        axes.axhline(part * height - 0.5, color="white", linewidth=0.8, linestyle=":")
    x, y = heat.mean_position
    axes.plot(x * width - 0.5, y * height - 0.5, marker="+", color="#40e0d0", markersize=14, markeredgewidth=2)
    figure.colorbar(shown, ax=axes, label="frames in which it moves [%]", fraction=0.025, pad=0.01)
    numbers = f"middle third {heat.central_third:.0%} of the mass, entropy {heat.entropy:.2f}, {heat.frames} frames"
    axes.set_title(f"{title}: {numbers}" if title else numbers, fontsize=10)
    axes.set_xticks([])
    axes.set_yticks([])
    save_figure(figure, path)
