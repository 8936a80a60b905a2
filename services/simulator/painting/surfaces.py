# SPDX-License-Identifier: Apache-2.0
"""Painted textures of the ground, walls and plants. Each painter returns a BGR uint8 image that repeats."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]
Floats32 = NDArray[np.float32]
Colour = tuple[float, float, float]

_HAZE = np.array([214, 204, 194], np.float32)
_ZENITH = np.array([222, 168, 118], np.float32)
_HORIZON = np.array([232, 220, 206], np.float32)
_CLOUD = np.array([246, 244, 242], np.float32)


def noise(rng: np.random.Generator, height: int, width: int, cells: Sequence[tuple[int, float]]) -> Floats32:
    """Sum of repeating value noise, (height, width); `cells` lists (cells along the longer side, amplitude)."""
    total = np.zeros((height, width), np.float32)
    longer = max(height, width)
    for count, amplitude in cells:
        rows, columns = max(1, count * height // longer), max(1, count * width // longer)
        grid = rng.uniform(-1.0, 1.0, (rows, columns)).astype(np.float32)
        # A ring of cells from the other side makes the enlarged grid meet itself without a seam.
        grid = np.pad(grid, 2, mode="wrap")
        size = ((columns + 4) * width // columns, (rows + 4) * height // rows)
        fine = cv2.resize(grid, size, interpolation=cv2.INTER_CUBIC)
        top, left = 2 * height // rows, 2 * width // columns
        total += amplitude * fine[top : top + height, left : left + width]
    return total


def coloured(value: Floats32, colour: Colour) -> Floats32:
    """A colour (BGR, 0 to 255) lightened or darkened by `value` (0 = as it is, in grey levels)."""
    base = np.asarray(colour, np.float32)
    return base + value[..., None] * (0.5 + 0.5 * base / max(float(base.max()), 1.0))


def to_image(values: Floats32) -> Image:
    """Rounded and clipped to uint8."""
    return np.asarray(np.clip(values + 0.5, 0.0, 255.0), np.uint8)


def asphalt(rng: np.random.Generator, size: int = 1024) -> Image:
    """Worn road: grain, pebbles, stains, tar seams and cracks. 10 m square."""
    value = noise(rng, size, size, [(4, 7), (10, 8), (28, 9), (80, 10), (256, 11), (512, 12)])
    pebbles = rng.integers(0, size, (1500, 2))
    for (x, y), tone in zip(pebbles.tolist(), rng.uniform(-55, 55, len(pebbles)).tolist(), strict=True):
        cv2.circle(value, (x, y), int(rng.integers(1, 4)), tone, -1)
    canvas = value
    for _ in range(16):
        _crack(rng, canvas, float(rng.uniform(-60, -35)))
    return to_image(coloured(canvas, (112.0, 110.0, 108.0)))


def _crack(rng: np.random.Generator, canvas: Floats32, tone: float) -> None:
    size = canvas.shape[0]
    angle = rng.uniform(0.0, 2.0 * np.pi)
    turns = np.cumsum(rng.normal(0.0, 0.35, 24)) + angle
    steps = np.stack([np.cos(turns), np.sin(turns)], axis=1) * rng.uniform(5.0, 13.0)
    line = np.cumsum(steps, axis=0) + rng.uniform(0, size, 2)
    for dx in (-size, 0, size):
        for dy in (-size, 0, size):
            points = np.round(line + np.array([dx, dy])).astype(np.int32)
            cv2.polylines(canvas, [points], False, tone, int(rng.integers(1, 4)) if dx == dy == 0 else 2)


def paving(rng: np.random.Generator, size: int = 512) -> Image:
    """Concrete slabs of half a metre, each of its own tone. 4 m square."""
    value = noise(rng, size, size, [(6, 8), (60, 9), (256, 12)])
    slabs = 8
    tones = rng.uniform(-24.0, 24.0, (slabs, slabs)).astype(np.float32)
    value += np.kron(tones, np.ones((size // slabs, size // slabs), np.float32))
    edge = size // slabs
    for k in range(slabs):
        value[k * edge : k * edge + 3] -= 45.0
        value[:, k * edge : k * edge + 3] -= 45.0
    return to_image(coloured(value, (150.0, 154.0, 158.0)))


def grass(rng: np.random.Generator, size: int = 512) -> Image:
    """Lawn with bare patches. 5 m square."""
    value = noise(rng, size, size, [(5, 16), (16, 14), (64, 18), (256, 22)])
    bare = np.clip(noise(rng, size, size, [(4, 1.0), (11, 0.7)]) - 0.5, 0.0, 1.0)[..., None]
    return to_image(coloured(value, (58.0, 108.0, 88.0)) * (1 - bare) + coloured(value, (90.0, 120.0, 140.0)) * bare)


def leaves(rng: np.random.Generator, colour: Colour, size: int = 256) -> Image:
    """Foliage: clumps with dark gaps and single bright leaves."""
    value = noise(rng, size, size, [(8, 26), (20, 26), (48, 24), (128, 20)])
    canvas = coloured(value - 12.0, colour)
    for x, y in rng.integers(0, size, (650, 2)).tolist():
        tone = float(rng.uniform(0.45, 1.6))
        axes = (int(rng.integers(2, 6)), int(rng.integers(1, 4)))
        paint = tuple(float(c) * tone for c in colour)
        cv2.ellipse(canvas, (x, y), axes, float(rng.uniform(0, 180)), 0, 360, paint, -1)
    return to_image(canvas)


def bark(rng: np.random.Generator, size: int = 128) -> Image:
    """Bark with upright furrows."""
    furrows = noise(rng, 1, size, [(12, 26), (40, 22)]).repeat(size, axis=0)
    return to_image(coloured(furrows + noise(rng, size, size, [(10, 16), (40, 16)]), (62.0, 78.0, 96.0)))


def bricks(rng: np.random.Generator, colour: Colour, height: int, width: int, rows: int) -> Floats32:
    """Brick wall as float canvas (height, width, 3), each brick of its own tone."""
    value = noise(rng, height, width, [(6, 8), (128, 8)])
    course = height / rows
    length = 2.6 * course
    columns = max(1, round(width / length))
    tone = rng.uniform(-26.0, 26.0, (rows, columns))
    row_of = np.minimum((np.arange(height) / course).astype(int), rows - 1)
    for row in range(rows):
        y0, y1 = round(row * course), round((row + 1) * course)
        shift = 0.5 * (row % 2)
        column = (np.floor(np.arange(width) / width * columns + shift).astype(int)) % columns
        value[y0:y1] += tone[row][column].astype(np.float32)
        joint = np.diff(column, prepend=column[-1]) != 0
        value[y0:y1][:, joint] += 34.0
    value[np.diff(row_of, prepend=-1) != 0] += 34.0
    return coloured(value, colour)


def plaster(rng: np.random.Generator, colour: Colour, height: int, width: int) -> Floats32:
    """Rough plaster with rain streaks, as float canvas."""
    value = noise(rng, height, width, [(4, 8), (14, 7), (90, 7), (300, 10)])
    value += noise(rng, 1, width, [(24, 5), (90, 5)]) * np.linspace(1.2, 0.3, height, dtype=np.float32)[:, None]
    return coloured(value, colour)


def planks(rng: np.random.Generator, colour: Colour, height: int, width: int, rows: int) -> Floats32:
    """Weathered boards, as float canvas."""
    value = noise(rng, height, 1, [(height // 3, 4)]).repeat(width, axis=1) + noise(rng, height, width, [(200, 8)])
    edges = np.linspace(0, height, rows + 1).astype(int)
    for y0, y1 in pairwise(edges):
        value[y0:y1] += rng.uniform(-18.0, 18.0)
        value[y0 : y0 + 2] -= 40.0
    return coloured(value, colour)


def roof_tiles(rng: np.random.Generator, colour: Colour, size: int = 256) -> Image:
    """Rows of roof tiles. 4 m square."""
    value = noise(rng, size, size, [(6, 14), (40, 8)])
    rows, columns = 14, 16
    value += np.kron(rng.uniform(-16, 16, (16, 16)), np.ones((size // 16, size // 16))).astype(np.float32)
    value += (20.0 * ((np.arange(size) * rows / size) % 1.0) - 14.0).astype(np.float32)[:, None]
    value -= 22.0 * (((np.arange(size) * columns / size) % 1.0) < 0.12).astype(np.float32)
    return to_image(coloured(value, colour))


def speckle(rng: np.random.Generator, colour: Colour, strength: float, size: int = 64) -> Image:
    """Plain surface with a little dirt."""
    return to_image(coloured(noise(rng, size, size, [(3, strength), (12, strength), (32, strength)]), colour))


def worn_paint(rng: np.random.Generator, size: int = 128) -> Image:
    """Road marking, rubbed off here and there."""
    wear = np.clip(noise(rng, size, size, [(6, 0.5), (24, 0.5), (64, 0.5)]) - 0.25, 0.0, 1.0)[..., None]
    white = coloured(noise(rng, size, size, [(32, 8)]), (222.0, 224.0, 224.0))
    return to_image(white * (1.0 - wear) + 118.0 * wear)


def patch(rng: np.random.Generator, size: int = 256) -> Image:
    """Mended road: darker tar, a bright seam, a few cracks."""
    value = noise(rng, size, size, [(6, 8), (30, 9), (128, 14)])
    for _ in range(5):
        _crack(rng, value, -35.0)
    cv2.rectangle(value, (3, 3), (size - 4, size - 4), 34.0, 4)
    return to_image(coloured(value, (82.0, 80.0, 80.0)))


def manhole(rng: np.random.Generator, size: int = 128) -> Image:
    """Cast-iron cover with its pattern."""
    canvas = coloured(noise(rng, size, size, [(20, 8), (64, 8)]), (108.0, 106.0, 105.0))
    centre = (size // 2, size // 2)
    cv2.circle(canvas, centre, size // 2 - 4, (52.0, 54.0, 58.0), -1)
    for x in range(14, size, 14):
        for y in range(14, size, 14):
            if (x - centre[0]) ** 2 + (y - centre[1]) ** 2 < (size // 2 - 14) ** 2:
                cv2.rectangle(canvas, (x - 3, y - 3), (x + 3, y + 3), (128.0, 130.0, 134.0), -1)
    cv2.circle(canvas, centre, size // 2 - 4, (150.0, 150.0, 150.0), 3)
    return to_image(canvas)


def tree_line(rng: np.random.Generator, height: int = 128, width: int = 1024) -> Image:
    """Distant wood, lighter towards the top where haze lies."""
    value = noise(rng, height, width, [(24, 16), (80, 20), (256, 18)])
    haze = np.linspace(0.55, 0.25, height, dtype=np.float32)[:, None, None]
    return to_image(coloured(value, (74.0, 98.0, 84.0)) * (1 - haze) + _HAZE * haze)


def clouds(rng: np.random.Generator, height: int = 256, width: int = 1024) -> Image:
    """Sky from the zenith (row 0) to the horizon (last row), all the way round."""
    down = np.linspace(0.0, 1.0, height, dtype=np.float32)[:, None, None]
    blue = _ZENITH * (1.0 - down) + _HORIZON * down
    cover = np.clip(noise(rng, height, width, [(14, 0.5), (32, 0.35), (80, 0.22), (200, 0.1)]) + 0.05, 0.0, 0.8)
    return to_image(blue * (1.0 - cover[..., None]) + _CLOUD * cover[..., None])
