# SPDX-License-Identifier: Apache-2.0
"""Painted grounds, cladding and plants that only the town has. Each repeats."""

from __future__ import annotations

import cv2
import numpy as np

from services.simulator.painting.buildings.windows import fill, paint_glass
from services.simulator.painting.surfaces import Colour, Image, coloured, noise, to_image


def setts(rng: np.random.Generator, colour: Colour, size: int = 512) -> Image:
    """Small paving stones in rows, each of its own tone. 4 m square."""
    stones = 32
    edge = size // stones
    value = noise(rng, size, size, [(5, 10.0), (40, 8.0), (256, 10.0)])
    tones = rng.uniform(-30.0, 30.0, (stones, stones))
    for row in range(stones):
        shift = (row % 2) * edge // 2
        value[row * edge : (row + 1) * edge] += np.roll(np.repeat(tones[row], edge), shift).astype(np.float32)
        value[row * edge : row * edge + 2] -= 40.0
        joints = (np.arange(stones) * edge + shift) % size
        value[row * edge : (row + 1) * edge, joints] -= 40.0
    return to_image(coloured(value, colour))


def gravel(rng: np.random.Generator, size: int = 256) -> Image:
    """Loose stones. 3 m square."""
    value = noise(rng, size, size, [(6, 10.0), (60, 16.0), (128, 26.0)])
    return to_image(coloured(value, (140.0, 152.0, 162.0)))


def corrugated(rng: np.random.Generator, colour: Colour, size: int = 256) -> Image:
    """Profiled sheet metal with rust and dents. 4 m square."""
    wave = 22.0 * np.sin(np.arange(size) * 2.0 * np.pi * 20.0 / size)
    value = noise(rng, size, size, [(4, 9.0), (30, 7.0)]) + wave.astype(np.float32)[None, :]
    rust = np.clip(noise(rng, size, size, [(5, 0.6), (14, 0.5), (50, 0.4)]) - 0.55, 0.0, 0.8)[..., None]
    canvas = coloured(value, colour) * (1.0 - rust) + np.array([40.0, 70.0, 120.0], np.float32) * rust
    for y in (0, size // 2):
        canvas[y : y + 3] *= 0.6
        canvas[y + 8 : y + 10, ::13] *= 0.4
    return to_image(canvas)


def gate(rng: np.random.Generator, size: int = 256) -> Image:
    """A roller gate with a small door and stripes of warning paint."""
    blue, green, red = rng.uniform(40.0, 170.0, 3).tolist()
    value = noise(rng, size, size, [(4, 8.0), (30, 8.0)])
    value -= np.where(np.arange(size) % 16 < 3, 42.0, 0.0).astype(np.float32)[:, None]
    canvas = coloured(value, (blue, green, red))
    fill(canvas, (166, 80, 226, 255), (blue * 0.6, green * 0.6, red * 0.6), 4)
    for k in range(5):
        paint_glass(rng, canvas, (12 + 47 * k, 24, 50 + 47 * k, 52))
    for k in range(0, size, 32):
        cv2.fillPoly(canvas, [np.array([[k, 255], [k + 16, 255], [k + 28, 240], [k + 12, 240]])], (30.0, 190.0, 230.0))
    return to_image(canvas)


def hedge(rng: np.random.Generator, size: int = 256) -> Image:
    """Clipped hedge: dense small leaves with dark depths and a few blossoms. 2 m square."""
    value = noise(rng, size, size, [(7, 18.0), (30, 26.0), (90, 30.0)])
    canvas = coloured(value - 10.0, (52.0, 104.0, 76.0))
    for x, y in rng.integers(0, size, (500, 2)).tolist():
        tone = float(rng.uniform(0.4, 1.7))
        cv2.circle(canvas, (x, y), int(rng.integers(1, 4)), (50.0 * tone, 104.0 * tone, 74.0 * tone), -1)
    for x, y in rng.integers(0, size, (40, 2)).tolist():
        cv2.circle(canvas, (x, y), 2, (200.0, 190.0, 236.0), -1)
    return to_image(canvas)


def birch_bark(rng: np.random.Generator, size: int = 128) -> Image:
    """White bark with dark scars."""
    canvas = coloured(noise(rng, size, size, [(6, 12.0), (40, 9.0)]), (206.0, 212.0, 216.0))
    for x, y in rng.integers(0, size, (50, 2)).tolist():
        axes = (int(rng.integers(3, 14)), int(rng.integers(1, 4)))
        cv2.ellipse(canvas, (x, y), axes, 0.0, 0, 360, (44.0, 48.0, 52.0), -1)
    return to_image(canvas)


def needles(rng: np.random.Generator, colour: Colour, size: int = 256) -> Image:
    """Branches of a conifer, hanging."""
    canvas = coloured(noise(rng, size, size, [(8, 22.0), (40, 24.0)]) - 16.0, colour)
    for x, y in rng.integers(0, size, (700, 2)).tolist():
        tone = float(rng.uniform(0.35, 1.6))
        end = (x + int(rng.integers(-7, 8)), y + int(rng.integers(6, 20)))
        cv2.line(canvas, (x, y), end, (colour[0] * tone, colour[1] * tone, colour[2] * tone), 2)
    return to_image(canvas)


def railing(rng: np.random.Generator, colour: Colour, size: int = 128) -> Image:
    """Balcony railing: bars before frosted glass. 2 m wide, 1 m high."""
    canvas = coloured(noise(rng, size, size, [(6, 12.0), (24, 10.0)]), colour)
    canvas[:, ::16] *= 0.45
    canvas[:, 1::16] *= 0.45
    canvas[:10] *= 0.4
    canvas[-8:] *= 0.4
    return to_image(canvas)


def timetable(rng: np.random.Generator, size: int = 128) -> Image:
    """A bus stop's board: a coloured head and lines of small print."""
    board = np.full((size, size, 3), 232, np.uint8)
    cv2.rectangle(board, (0, 0), (size, 30), (40.0, 150.0, 60.0), -1)
    cv2.putText(board, "BUS", (30, 24), cv2.FONT_HERSHEY_DUPLEX, 0.8, (240.0, 240.0, 240.0), 2)
    for y in range(40, size - 6, 7):
        x = 8
        while x < size - 20:
            wide = int(rng.integers(4, 18))
            cv2.rectangle(board, (x, y), (x + wide, y + 2), (60.0, 60.0, 60.0), -1)
            x += wide + 5
    return board


def lamp_glass(rng: np.random.Generator, size: int = 32) -> Image:
    """Traffic light: red, amber and green lens on black."""
    canvas = coloured(noise(rng, 2 * size, size, [(4, 5.0)]), (34.0, 34.0, 34.0))
    for k, colour in enumerate(((40.0, 40.0, 220.0), (40.0, 120.0, 150.0), (60.0, 110.0, 40.0))):
        cv2.circle(canvas, (size // 2, 11 + 21 * k), 8, colour, -1)
    return to_image(canvas)


def arrow(rng: np.random.Generator, kind: int, size: int = 128) -> Image:
    """Lane arrow on asphalt, 4.5 m by 2.2 m: ahead (0), ahead and right (1). u leads ahead, v to the left."""
    mask = np.zeros((220, 450), np.uint8)
    ways = [((20, 110), (350, 110)), ((150, 110), (280, 52))]
    for start, end in ways[: kind + 1]:
        cv2.line(mask, start, end, 255, 18)
        way = np.array(end, np.float64) - start
        ahead, aside = way / np.linalg.norm(way), np.array([-way[1], way[0]]) / np.linalg.norm(way)
        cv2.fillConvexPoly(mask, np.rint([end + 32 * aside, end - 32 * aside, end + 75 * ahead]).astype(np.int32), 255)
    paint = cv2.resize(mask, (size, size), interpolation=cv2.INTER_AREA).astype(np.float32)[..., None] / 255.0
    canvas = coloured(noise(rng, size, size, [(10, 8.0), (50, 10.0)]), (104.0, 102.0, 100.0))
    canvas = canvas * (1.0 - paint) + np.array([214.0, 216.0, 216.0], np.float32) * paint
    return to_image(canvas + noise(rng, size, size, [(40, 16.0)])[..., None])
