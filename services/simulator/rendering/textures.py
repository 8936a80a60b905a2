# SPDX-License-Identifier: Apache-2.0
"""Textures in one image, filtered along both of their axes, so that near and far look alike from frame to frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]
Floats32 = NDArray[np.float32]

_ATLAS_WIDTH_PX = 8192
_MAX_LEVELS = 12


@dataclass(frozen=True, slots=True)
class Lookup:
    """Where to look up a texture, one value a pixel, all float32 of one shape.

    log2_width, log2_height: size of the texture; x0_px, y0_px: its place in the atlas; u, v: position in tiles;
    du, dv: extent of the pixel's footprint in tiles.
    """

    log2_width: Floats32
    log2_height: Floats32
    x0_px: Floats32
    y0_px: Floats32
    u: Floats32
    v: Floats32
    du: Floats32
    dv: Floats32


class TextureAtlas:
    """All textures as rip-maps (halved independently along u and v; Simonsen's and McReynolds' answer to slanted
    surfaces), side by side in one image, so that one `cv2.remap` serves every pixel whatever its texture.

    Textures are BGR uint8 whose sides are powers of two; they repeat.
    """

    def __init__(self, textures: Mapping[str, Image]) -> None:
        self.index = {name: number for number, name in enumerate(textures)}
        images = list(textures.values())
        self.log2_size = np.array(
            [[int(np.log2(image.shape[1])), int(np.log2(image.shape[0]))] for image in images], np.float32
        )
        self.origin_px = np.zeros((len(images), 2), np.float32)
        blocks = [_rip_map(image) for image in images]
        self._image = np.zeros((self._place(blocks), _ATLAS_WIDTH_PX, 3), np.uint8)
        for block, (x, y) in zip(blocks, self.origin_px.astype(int), strict=True):
            self._image[y : y + block.shape[0], x : x + block.shape[1]] = block

    def _place(self, blocks: list[Image]) -> int:
        """Shelves, the highest blocks first; returns the height needed."""
        x = y = shelf_px = 0
        for number in sorted(range(len(blocks)), key=lambda n: (-blocks[n].shape[0], n)):
            height, width = blocks[number].shape[:2]
            if x + width > _ATLAS_WIDTH_PX:
                x, y, shelf_px = 0, y + shelf_px, 0
            self.origin_px[number] = (x, y)
            x, shelf_px = x + width, max(shelf_px, height)
        return y + shelf_px

    def sample(self, at: Lookup) -> Floats32:
        """Colours, shape of the lookup + (3,), 0 to 255, blended between the four nearest rip-map levels."""
        x_near, x_far, x_blend = _level_positions(at.log2_width, at.x0_px, at.u, at.du)
        y_near, y_far, y_blend = _level_positions(at.log2_height, at.y0_px, at.v, at.dv)
        near = _mix(self._fetch(x_near, y_near), self._fetch(x_far, y_near), x_blend)
        far = _mix(self._fetch(x_near, y_far), self._fetch(x_far, y_far), x_blend)
        return _mix(near, far, y_blend)

    def _fetch(self, x: Floats32, y: Floats32) -> Floats32:
        return cv2.remap(self._image, x, y, cv2.INTER_LINEAR).astype(np.float32)


def _mix(a: Floats32, b: Floats32, weight_of_b: Floats32) -> Floats32:
    b -= a
    b *= weight_of_b[..., None]
    b += a
    return b


_SHRINK = np.exp2(-np.arange(_MAX_LEVELS + 2)).astype(np.float32)


def _level_positions(
    log2_size: Floats32, origin_px: Floats32, at: Floats32, footprint: Floats32
) -> tuple[Floats32, Floats32, Floats32]:
    """Atlas coordinate in the two nearest levels along one axis, and the weight of the coarser one."""
    size = np.exp2(log2_size)
    level = np.clip(np.log2(np.maximum(footprint * size, 1.0)), 0.0, log2_size)
    fine = np.minimum(np.floor(level), np.maximum(log2_size - 1.0, 0.0))
    fraction = at - np.floor(at)
    positions = []
    for step in (fine, np.minimum(fine + 1.0, log2_size)):
        shrink = _SHRINK[step.astype(np.intp)]
        # Level k begins after the 2 * size * (1 - 2^-k) texels of the finer ones and their borders of two each.
        begin = origin_px + 2.0 * size * (1.0 - shrink) + 2.0 * step + 1.0
        positions.append(begin + fraction * (size * shrink) - 0.5)
    return positions[0], positions[1], level - fine


def _rip_map(image: Image) -> Image:
    """All levels of one texture, each with a border of one texel that continues it on the other side."""
    rows = []
    for vertical in _halvings(image, axis=0):
        row = [cv2.copyMakeBorder(level, 1, 1, 1, 1, cv2.BORDER_WRAP) for level in _halvings(vertical, axis=1)]
        rows.append(np.concatenate(row, axis=1))
    return np.concatenate(rows, axis=0)


def _halvings(image: Image, axis: int) -> list[Image]:
    levels = [image]
    while levels[-1].shape[axis] > 1:
        height, width = levels[-1].shape[:2]
        size = (width, height // 2) if axis == 0 else (width // 2, height)
        levels.append(
            np.asarray(cv2.resize(levels[-1], size, interpolation=cv2.INTER_AREA), np.uint8).reshape(
                size[1], size[0], 3
            )
        )
    return levels
