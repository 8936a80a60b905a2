# SPDX-License-Identifier: Apache-2.0
"""Painted shops, their name boards, posters and a mural: things that make one place unlike another."""

from __future__ import annotations

import cv2
import numpy as np

from services.simulator.painting.buildings.windows import fill, paint_glass, toned
from services.simulator.painting.surfaces import Colour, Image, coloured, noise, plaster, to_image

SHOPS, BOARDS, POSTERS, MURALS = 9, 8, 10, 3
"""How many of each are painted for one town."""
SHOP_M = (12.0, 3.6)
"""Width and height of what a shop's texture covers."""
_TRADES = ("BAKERY", "CAFE", "BOOKS", "BIKES", "FLOWERS", "TOOLS", "SHOES", "HAIR", "MARKET", "OPTIK", "BAR", "MUSIC")
_SYLLABLES = ("KO", "LA", "MER", "TO", "RIN", "SA", "BEL", "NOR", "VI", "DA", "HAL", "UM", "PE", "STA")
_FONTS = (cv2.FONT_HERSHEY_SIMPLEX, cv2.FONT_HERSHEY_DUPLEX, cv2.FONT_HERSHEY_TRIPLEX, cv2.FONT_HERSHEY_COMPLEX)


def _colour(rng: np.random.Generator, low: float, high: float) -> Colour:
    blue, green, red = rng.uniform(low, high, 3).tolist()
    return (blue, green, red)


def _name(rng: np.random.Generator) -> str:
    return "".join(str(rng.choice(_SYLLABLES)) for _ in range(int(rng.integers(2, 4))))


def _write(rng: np.random.Generator, canvas: Image, text: str, box: tuple[int, int, int, int], colour: Colour) -> None:
    """Text as large as fits into a box (x, y, width, height)."""
    font = int(rng.choice(_FONTS))
    (wide, high), _ = cv2.getTextSize(text, font, 1.0, 2)
    scale = min(box[2] / wide, box[3] / high)
    at = (round(box[0] + 0.5 * (box[2] - wide * scale)), round(box[1] + 0.5 * (box[3] + high * scale)))
    cv2.putText(canvas, text, at, font, scale, colour, max(1, round(2.2 * scale)), cv2.LINE_AA)


def paint_shop(rng: np.random.Generator, number: int) -> Image:
    """A shop's ground floor, (256, 1024, 3): name board, two large windows full of goods, a door."""
    front = _colour(rng, 30.0, 150.0)
    canvas = plaster(rng, front, 256, 1024)
    fill(canvas, (0, 4, 1024, 56), toned(front, 0.5))
    door = int(rng.integers(0, 3))
    for k in range(4):
        x0, x1 = 256 * k + 14, 256 * k + 242
        if k == door + 1:
            fill(canvas, (x0 + 50, 78, x1 - 50, 250), toned(front, 0.4))
            paint_glass(rng, canvas, (x0 + 62, 90, x1 - 62, 236))
            continue
        fill(canvas, (x0, 70, x1, 216), toned(front, 1.5))
        paint_glass(rng, canvas, (x0 + 7, 77, x1 - 7, 209))
        for _ in range(26):
            x, y = int(rng.integers(x0 + 12, x1 - 34)), int(rng.integers(100, 186))
            size = (int(rng.integers(6, 30)), int(rng.integers(6, 24)))
            fill(canvas, (x, y, x + size[0], min(y + size[1], 207)), _colour(rng, 20.0, 240.0))
        fill(canvas, (x0 + 7, 150, x1 - 7, 154), (120.0, 120.0, 120.0))
    canvas[-18:] *= 0.5
    image = to_image(canvas)
    _write(rng, image, f"{_TRADES[number % len(_TRADES)]} {_name(rng)}", (60, 10, 900, 40), (232.0, 238.0, 240.0))
    return image


def paint_board(rng: np.random.Generator, number: int) -> Image:
    """A name board, (128, 512, 3)."""
    ground = _colour(rng, 20.0, 235.0)
    canvas = to_image(coloured(noise(rng, 128, 512, [(30, 8.0), (120, 6.0)]), ground))
    dark = sum(ground) > 360.0
    ink: Colour = (24.0, 24.0, 28.0) if dark else (236.0, 240.0, 240.0)
    cv2.rectangle(canvas, (6, 6), (505, 121), ink, 4)
    _write(rng, canvas, _TRADES[(number * 5 + 3) % len(_TRADES)], (30, 24, 452, 78), ink)
    return canvas


def paint_poster(rng: np.random.Generator) -> Image:
    """An advertisement of shapes and words, (256, 256, 3)."""
    canvas = to_image(coloured(noise(rng, 256, 256, [(2, 50.0), (5, 25.0)]), _colour(rng, 60.0, 230.0)))
    for _ in range(int(rng.integers(5, 11))):
        at = (int(rng.integers(0, 256)), int(rng.integers(0, 200)))
        colour = _colour(rng, 0.0, 255.0)
        if rng.random() < 0.5:
            cv2.circle(canvas, at, int(rng.integers(10, 62)), colour, -1)
        else:
            points = (np.array(at) + rng.integers(-70, 70, (int(rng.integers(3, 6)), 2))).astype(np.int32)
            cv2.fillPoly(canvas, [points], colour)
    _write(rng, canvas, _name(rng), (16, 176, 224, 40), _colour(rng, 200.0, 255.0))
    _write(
        rng, canvas, f"{int(rng.integers(2, 99))}.{int(rng.integers(10, 99))}", (60, 222, 130, 24), (10.0, 10.0, 10.0)
    )
    cv2.rectangle(canvas, (0, 0), (255, 255), (230.0, 230.0, 230.0), 5)
    return canvas


def paint_mural(rng: np.random.Generator) -> Image:
    """A painted gable, (512, 512, 3): large curved shapes over plaster."""
    canvas = plaster(rng, _colour(rng, 120.0, 220.0), 512, 512)
    for _ in range(16):
        turns = np.cumsum(rng.normal(0.0, 0.7, 26)) + rng.uniform(0.0, 6.28)
        line = np.cumsum(np.stack([np.cos(turns), np.sin(turns)], axis=1) * 30.0, axis=0) + rng.uniform(0, 512, 2)
        points = [np.round(line).astype(np.int32)]
        cv2.polylines(canvas, points, False, _colour(rng, 20.0, 240.0), int(rng.integers(8, 46)), cv2.LINE_AA)
    for _ in range(24):
        at = (int(rng.integers(0, 512)), int(rng.integers(0, 512)))
        cv2.circle(canvas, at, int(rng.integers(4, 30)), _colour(rng, 20.0, 240.0), -1)
    return to_image(canvas + noise(rng, 512, 512, [(120, 9.0)])[..., None])
