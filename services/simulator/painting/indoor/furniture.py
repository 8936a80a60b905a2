# SPDX-License-Identifier: Apache-2.0
"""Painted fronts of what stands in an office."""

from __future__ import annotations

import cv2
import numpy as np

from services.simulator.painting.indoor.prints import INK, any_colour, small_print
from services.simulator.painting.surfaces import Image, coloured, noise, to_image


def radiator(rng: np.random.Generator, width: int = 256, height: int = 128) -> Image:
    """Ribs of sheet metal, dark between them."""
    value = noise(rng, height, width, [(6, 4), (64, 4)])
    value[:, np.arange(width) % 16 < 3] -= 74.0
    value[:6] -= 40.0
    value[-6:] -= 60.0
    return to_image(coloured(value, (226.0, 230.0, 230.0)))


def machine(rng: np.random.Generator, width: int = 128, height: int = 256) -> Image:
    """Front of a vending machine: lit shelves of goods, a slot, buttons."""
    canvas = coloured(noise(rng, height, width, [(4, 10), (64, 6)]), (64.0, 48.0, 40.0))
    for y in range(26, 170, 28):
        cv2.rectangle(canvas, (10, y), (88, y + 22), (226.0, 228.0, 224.0), -1)
        for x in range(14, 84, 13):
            cv2.rectangle(canvas, (x, y + 5), (x + 9, y + 21), any_colour(rng), -1)
    for y in range(40, 120, 14):
        for x in (96, 106, 116):
            cv2.circle(canvas, (x, y), 4, (196.0, 200.0, 200.0), -1)
    cv2.rectangle(canvas, (18, 196), (84, 224), (24.0, 22.0, 22.0), -1)
    return to_image(canvas)


def cupboard(rng: np.random.Generator, size: int = 256) -> Image:
    """Two doors of a steel cupboard with handles, labels and a magnet or two."""
    canvas = coloured(noise(rng, size, size, [(4, 7), (32, 5), (256, 6)]), (150.0, 156.0, 150.0))
    cv2.line(canvas, (size // 2, 0), (size // 2, size), INK, 3)
    cv2.rectangle(canvas, (2, 2), (size - 3, size - 3), (90.0, 92.0, 92.0), 4)
    for x in (size // 2 - 20, size // 2 + 12):
        cv2.rectangle(canvas, (x, 110), (x + 8, 150), (60.0, 60.0, 62.0), -1)
    for _ in range(5):
        x, y = (int(v) for v in rng.integers(20, size - 60, 2))
        cv2.rectangle(
            canvas, (x, y), (x + int(rng.integers(14, 44)), y + int(rng.integers(10, 40))), any_colour(rng), -1
        )
    return to_image(canvas)


def books(rng: np.random.Generator, size: int = 256) -> Image:
    """Four shelves of files and books."""
    canvas = np.full((size, size, 3), 46.0, np.float32)
    for shelf in range(4):
        x, floor = 4, (shelf + 1) * 64 - 6
        while x < size - 10:
            width, height = int(rng.integers(6, 18)), int(rng.integers(34, 54))
            cv2.rectangle(canvas, (x, floor - height), (x + width, floor), any_colour(rng), -1)
            cv2.line(
                canvas, (x + width // 2, floor - height + 6), (x + width // 2, floor - 20), any_colour(rng, 170.0), 2
            )
            x += width + int(rng.integers(1, 4))
        cv2.rectangle(canvas, (0, floor), (size, floor + 6), (120.0, 158.0, 190.0), -1)
    return to_image(canvas)


def screen(rng: np.random.Generator, width: int = 256, height: int = 128) -> Image:
    """A monitor's picture: windows, text, a plot."""
    canvas = coloured(noise(rng, height, width, [(3, 16)]), any_colour(rng, 60.0))
    for _ in range(3):
        x, y = int(rng.integers(4, width - 120)), int(rng.integers(4, height - 60))
        cv2.rectangle(canvas, (x, y), (x + 112, y + 56), (236.0, 236.0, 236.0), -1)
        cv2.rectangle(canvas, (x, y), (x + 112, y + 8), any_colour(rng), -1)
        small_print(rng, canvas, (x + 6, y + 14, x + 104, y + 54))
    curve = np.cumsum(rng.normal(0.0, 5.0, 24)) + 90.0
    points = np.stack([np.linspace(130, 250, 24), np.clip(curve, 66, 122)], axis=1).astype(np.int32)
    cv2.rectangle(canvas, (126, 62), (252, 124), (30.0, 30.0, 30.0), -1)
    cv2.polylines(canvas, [points], False, (80.0, 230.0, 120.0), 2)
    cv2.rectangle(canvas, (0, 0), (width - 1, height - 1), (16.0, 16.0, 16.0), 5)
    return to_image(canvas)
