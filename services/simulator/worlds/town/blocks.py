# SPDX-License-Identifier: Apache-2.0
"""The outline of a group of town blocks: the polygon that the loop of streets follows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Cell = tuple[int, int]

_SMALLEST_BLOCK_M, _LARGEST_BLOCK_M = 79.0, 128.0
_SIDES = ((1, 0), (-1, 0), (0, 1), (0, -1))
_GRID_JITTER = 0.10
_CORNER_JITTER = 0.05


def town_outline(rng: np.random.Generator, loop_m: float) -> Floats:
    """Corners (K, 2) of the outline of some blocks, counter-clockwise, metres; its length is near `loop_m`.

    Rectangles, L, T and other shapes, each without holes and without blocks that meet at a corner only; streets meet
    at roughly right angles.
    """
    low, high = loop_m / _LARGEST_BLOCK_M, loop_m / _SMALLEST_BLOCK_M
    counts = [count for count in range(4, 2 * int(high) + 2, 2) if low <= count <= high]
    perimeter = int(rng.choice(counts))
    cells = _grown(rng, perimeter)
    return _jittered(rng, np.array(_outline(cells), np.float64)) * (loop_m / perimeter)


def _grown(rng: np.random.Generator, perimeter: int) -> set[Cell]:
    """Blocks grown one by one from the first until their outline has `perimeter` sides."""
    while True:
        cells: set[Cell] = {(0, 0)}
        for _ in range(perimeter * perimeter):
            now = _perimeter(cells)
            if now == perimeter:
                return cells
            beside = sorted({(x + dx, y + dy) for x, y in cells for dx, dy in _SIDES} - cells)
            grown = cells | {beside[int(rng.integers(0, len(beside)))]}
            if now <= _perimeter(grown) <= perimeter and _is_sound(grown):
                cells = grown


def _perimeter(cells: set[Cell]) -> int:
    return sum((x + dx, y + dy) not in cells for x, y in cells for dx, dy in _SIDES)


def _is_sound(cells: set[Cell]) -> bool:
    """No two blocks that meet at a corner only, no holes, and no gap of one block between two streets."""
    low = np.min(list(cells), axis=0) - 1
    high = np.max(list(cells), axis=0) + 1
    for x in range(low[0], high[0] + 1):
        for y in range(low[1], high[1] + 1):
            a, b, c, d = (((x + i, y + j) in cells) for i, j in ((0, 0), (1, 0), (0, 1), (1, 1)))
            if (a and d and not b and not c) or (b and c and not a and not d):
                return False
            if (x, y) not in cells and (
                ((x - 1, y) in cells and (x + 1, y) in cells) or ((x, y - 1) in cells and (x, y + 1) in cells)
            ):
                return False
    return True


def _outline(cells: set[Cell]) -> list[Cell]:
    """Corners of the outline, counter-clockwise, those on straight pieces left out."""
    following: dict[Cell, Cell] = {}
    for x, y in cells:
        ring = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]
        for side, (dx, dy) in enumerate(((0, -1), (1, 0), (0, 1), (-1, 0))):
            if (x + dx, y + dy) not in cells:
                following[ring[side]] = ring[(side + 1) % 4]
    first = min(following)
    around = [first]
    while following[around[-1]] != first:
        around.append(following[around[-1]])
    count = len(around)
    return [
        corner
        for k, corner in enumerate(around)
        if not (around[k - 1][0] == corner[0] == around[(k + 1) % count][0])
        and not (around[k - 1][1] == corner[1] == around[(k + 1) % count][1])
    ]


def _jittered(rng: np.random.Generator, corners: Floats) -> Floats:
    """Blocks of unequal sizes and corners that are not quite square."""
    moved = corners.copy()
    for axis in (0, 1):
        lines = np.unique(corners[:, axis])
        shift = rng.uniform(-_GRID_JITTER, _GRID_JITTER, len(lines))
        moved[:, axis] += shift[np.searchsorted(lines, corners[:, axis])]
    return moved + rng.uniform(-_CORNER_JITTER, _CORNER_JITTER, moved.shape)
