# SPDX-License-Identifier: Apache-2.0
"""Painted paper and signs of an office: posters, notes, words."""

from __future__ import annotations

import cv2
import numpy as np

from services.simulator.painting.surfaces import Colour, Floats32, Image, coloured, noise, to_image

INK: Colour = (40.0, 38.0, 36.0)


def poster(rng: np.random.Generator, size: int = 256) -> Image:
    """A printed sheet: ground, shapes, a headline, lines of text."""
    canvas = coloured(noise(rng, size, size, [(3, 20), (12, 8)]), any_colour(rng, 120.0))
    for _ in range(int(rng.integers(5, 11))):
        a, b = (tuple(int(v) for v in rng.integers(0, size, 2)) for _ in range(2))
        if rng.random() < 0.5:
            cv2.rectangle(canvas, a, b, any_colour(rng), -1 if rng.random() < 0.7 else 5)
        else:
            cv2.circle(canvas, a, int(rng.integers(12, 60)), any_colour(rng), -1 if rng.random() < 0.7 else 5)
    words = ("OPEN DAY", "ROBOTS", "SAFETY", "FLOOR 3", "WORKSHOP", "MEETING", "SUMMER", "MAPS", "COFFEE", "LIBRARY")
    cv2.rectangle(canvas, (0, 10), (size, 56), any_colour(rng, 190.0), -1)
    headline = words[int(rng.integers(0, len(words)))]
    write(canvas, headline, (12, 46), (1.3, 4), INK)
    cv2.rectangle(canvas, (12, 176), (size - 13, 244), (238.0, 240.0, 240.0), -1)
    small_print(rng, canvas, (20, 184, size - 22, 240))
    cv2.rectangle(canvas, (0, 0), (size - 1, size - 1), INK, 5)
    return to_image(canvas)


def notice_board(rng: np.random.Generator, size: int = 256) -> Image:
    """Cork, with notes pinned over each other."""
    canvas = coloured(noise(rng, size, size, [(64, 18), (256, 22)]), (86.0, 132.0, 176.0))
    for _ in range(17):
        x, y = (int(v) for v in rng.integers(6, size - 62, 2))
        w, h = (int(v) for v in rng.integers(30, 60, 2))
        cv2.rectangle(canvas, (x, y), (x + w, y + h), any_colour(rng, 170.0), -1)
        small_print(rng, canvas, (x + 4, y + 8, x + w - 4, y + h - 4))
        cv2.circle(canvas, (x + w // 2, y + 3), 3, any_colour(rng), -1)
    cv2.rectangle(canvas, (0, 0), (size - 1, size - 1), (120.0, 130.0, 140.0), 9)
    return to_image(canvas)


def exit_sign(rng: np.random.Generator, width: int = 128, height: int = 64) -> Image:
    """White letters on green."""
    canvas = coloured(noise(rng, height, width, [(4, 6)]), (90.0, 150.0, 40.0))
    write(canvas, "EXIT", (12, 46), (1.4, 4), (240.0, 244.0, 240.0))
    return to_image(canvas)


def badge(rng: np.random.Generator, size: int = 64) -> Image:
    """A name plate: a mark and small print."""
    canvas = coloured(noise(rng, size, size, [(6, 6)]), (230.0, 232.0, 232.0))
    small_print(rng, canvas, (8, 34, size - 8, size - 6))
    cv2.circle(canvas, (18, 18), 10, (120.0, 140.0, 180.0), -1)
    return to_image(canvas)


def small_print(rng: np.random.Generator, canvas: Floats32, box: tuple[int, int, int, int]) -> None:
    """Words too small to read, in rows."""
    left, top, right, bottom = box
    for y in range(top, bottom, 7):
        x = left
        while x < right - 6:
            width = int(rng.integers(4, 18))
            cv2.line(canvas, (x, y), (min(x + width, right), y), (90.0, 88.0, 86.0), 2)
            x += width + 5


def write(canvas: Floats32, text: str, at: tuple[int, int], size: tuple[float, int], ink: Colour) -> None:
    """Smooth letters of `size` (scale, thickness), which OpenCV only draws into bytes."""
    cover = np.zeros(canvas.shape[:2], np.uint8)
    cv2.putText(cover, text, at, cv2.FONT_HERSHEY_SIMPLEX, size[0], 255, size[1], cv2.LINE_AA)
    share = cover[..., None].astype(np.float32) / 255.0
    canvas += share * (np.asarray(ink, np.float32) - canvas)


def any_colour(rng: np.random.Generator, lift: float = 0.0) -> Colour:
    """Any colour, lighter by `lift`."""
    b, g, r = np.minimum(rng.uniform(20.0, 230.0, 3) * (1.0 - lift / 255.0) + lift, 250.0).tolist()
    return b, g, r
