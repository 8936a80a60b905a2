# SPDX-License-Identifier: Apache-2.0
"""Painted floors, ceilings, walls, windows and doors of an office."""

from __future__ import annotations

import cv2
import numpy as np

from services.simulator.painting.indoor.prints import INK, write
from services.simulator.painting.surfaces import Colour, Image, coloured, noise, to_image


def carpet(rng: np.random.Generator, size: int = 512) -> Image:
    """Carpet tiles of half a metre, every other one turned, stained here and there. 4 m square."""
    value = noise(rng, size, size, [(6, 8), (24, 6), (256, 13), (512, 12)])
    step = size // 8
    for row in range(8):
        for column in range(8):
            cell = np.s_[row * step : (row + 1) * step, column * step : (column + 1) * step]
            value[cell] += 8.0 * ((row + column) % 2) + float(rng.uniform(-7, 7))
            stripe = np.arange(step) % 8 < 2
            if (row + column) % 2:
                value[cell][:, stripe] -= 14.0
            else:
                value[cell][stripe] -= 14.0
    for _ in range(14):
        centre = (int(rng.integers(0, size)), int(rng.integers(0, size)))
        cv2.circle(value, centre, int(rng.integers(3, 14)), float(rng.uniform(-40, 20)), -1)
    return to_image(coloured(value, (118.0, 104.0, 92.0)))


def tiles(rng: np.random.Generator, size: int = 512) -> Image:
    """Floor tiles of half a metre with dark joints and veins. 4 m square."""
    value = noise(rng, size, size, [(5, 8), (16, 9), (64, 9), (256, 6)])
    step = size // 8
    for row in range(8):
        for column in range(8):
            value[row * step : (row + 1) * step, column * step : (column + 1) * step] += float(rng.uniform(-12, 12))
    for at in range(0, size, step):
        value[at : at + 2] -= 60.0
        value[:, at : at + 2] -= 60.0
    return to_image(coloured(value, (168.0, 176.0, 178.0)))


def ceiling(rng: np.random.Generator, size: int = 256) -> Image:
    """Mineral panels of 60 cm with small holes in a metal grid. 2.4 m square."""
    value = noise(rng, size, size, [(4, 4), (64, 5), (256, 6)])
    for x, y in rng.integers(0, size, (420, 2)).tolist():
        cv2.circle(value, (x, y), 1, -48.0, -1)
    for at in range(0, size, size // 4):
        value[at : at + 2] -= 46.0
        value[:, at : at + 2] -= 46.0
    return to_image(coloured(value, (226.0, 230.0, 230.0)))


def painted_wall(rng: np.random.Generator, colour: Colour, size: int = 512) -> Image:
    """Wood-chip paper under paint, with scuffs near the floor and a rail at hip height. 4 m wide, 2.8 m high."""
    value = noise(rng, size, size, [(4, 5), (12, 4), (128, 5), (256, 9)])
    for x, y in rng.integers(0, size, (900, 2)).tolist():
        cv2.circle(value, (x, y), int(rng.integers(1, 3)), float(rng.uniform(-16, 10)), -1)
    for _ in range(60):
        x, y = int(rng.integers(0, size)), int(rng.integers(int(0.78 * size), size))
        cv2.line(value, (x, y), (x + int(rng.integers(-30, 30)), y + int(rng.integers(-5, 5))), -38.0, 1)
    canvas = coloured(value, colour)
    rail = np.s_[int(0.66 * size) : int(0.69 * size)]
    canvas[rail] = coloured(noise(rng, size, size, [(64, 8), (256, 6)])[rail], (96.0, 126.0, 158.0))
    return to_image(canvas)


def window(rng: np.random.Generator, size: int = 256) -> Image:
    """Two casements on a bright day: sky, a house across the yard, a tree."""
    down = np.linspace(0.0, 1.0, size, dtype=np.float32)[:, None, None]
    canvas = np.asarray(np.array([250, 240, 226], np.float32) * (1 - 0.12 * down) * np.ones((1, size, 1), np.float32))
    top = int(rng.uniform(0.35, 0.55) * size)
    canvas[top:] = coloured(noise(rng, size, size, [(16, 8), (64, 8)]), (190.0, 200.0, 214.0))[top:]
    for x in range(int(rng.integers(6, 20)), size, 38):
        cv2.rectangle(canvas, (x, top + 16), (x + 20, top + 46), (128.0, 122.0, 116.0), -1)
    green = coloured(noise(rng, size, size, [(20, 26), (60, 26)]), (96.0, 160.0, 120.0))
    centre = (int(rng.integers(30, size - 30)), int(0.8 * size))
    crown = cv2.circle(np.zeros((size, size), np.uint8), centre, int(rng.integers(36, 60)), 1, -1).astype(bool)
    canvas[crown] = green[crown]
    for x in (0, size // 2 - 7, size - 14):
        cv2.rectangle(canvas, (x, 0), (x + 14, size), (224.0, 226.0, 226.0), -1)
        cv2.line(canvas, (x + 14, 0), (x + 14, size), (150.0, 150.0, 150.0), 2)
    for y in (0, size - 14):
        cv2.rectangle(canvas, (0, y), (size, y + 14), (224.0, 226.0, 226.0), -1)
    return to_image(canvas)


def door(rng: np.random.Generator, colour: Colour, kind: int, width: int = 128, height: int = 256) -> Image:
    """A door leaf with handle, plate and, by kind, a pane or panels."""
    canvas = coloured(noise(rng, height, width, [(4, 8), (16, 6), (200, 9)]), colour)
    cv2.rectangle(canvas, (3, 3), (width - 4, height - 1), INK, 2)
    if kind == 0:
        cv2.rectangle(canvas, (34, 34), (94, 132), (206.0, 204.0, 196.0), -1)
        cv2.rectangle(canvas, (34, 34), (94, 132), (70.0, 74.0, 76.0), 3)
        cv2.line(canvas, (40, 120), (86, 44), (240.0, 240.0, 240.0), 3)
    else:
        for y in (26, 146) if kind == 1 else (40,):
            cv2.rectangle(canvas, (26, y), (102, y + 84), tuple(0.7 * c for c in colour), 3)
    cv2.rectangle(canvas, (106, 128), (116, 160), (180.0, 184.0, 186.0), -1)
    cv2.line(canvas, (94, 138), (112, 138), (90.0, 92.0, 94.0), 5)
    cv2.rectangle(canvas, (44, 12), (84, 26), (236.0, 238.0, 238.0), -1)
    number = f"{int(rng.integers(1, 5))}.{int(rng.integers(10, 60))}"
    write(canvas, number, (46, 24), (0.42, 1), INK)
    return to_image(canvas)
