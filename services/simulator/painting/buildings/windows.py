# SPDX-License-Identifier: Apache-2.0
"""Windows and doors, painted onto a wall that is a canvas of float BGR."""

from __future__ import annotations

import cv2
import numpy as np

from services.simulator.painting.surfaces import Colour, Floats32, noise

Box = tuple[float, float, float, float]
"""Left, top, right, bottom in pixels."""

_GLASS = np.array([92, 78, 66], np.float32)
_CURTAIN = np.array([196, 202, 206], np.float32)


def toned(colour: Colour, factor: float) -> Colour:
    """A colour made lighter or darker."""
    return (colour[0] * factor, colour[1] * factor, colour[2] * factor)


def fill(canvas: Floats32, box: Box, colour: Colour, thickness: int = -1) -> None:
    """A rectangle, filled or as an outline."""
    x0, y0, x1, y1 = (round(value) for value in box)
    cv2.rectangle(canvas, (x0, y0), (x1, y1), colour, thickness)


def paint_glass(rng: np.random.Generator, canvas: Floats32, box: Box) -> None:
    """A pane: what it mirrors, and often a curtain, a blind or flowers behind it."""
    x0, y0, x1, y1 = (int(value) for value in box)
    pane = canvas[y0:y1, x0:x1]
    shine = noise(rng, pane.shape[0], pane.shape[1], [(3, 30.0), (7, 20.0)])
    pane[:] = _GLASS * rng.uniform(0.35, 1.25) + shine[..., None]
    choice = rng.random()
    if choice < 0.4:
        cover = int(pane.shape[0] * rng.uniform(0.25, 0.9))
        folds = 20.0 * np.sin(np.arange(pane.shape[1]) * rng.uniform(0.25, 0.6))
        tone = _CURTAIN * rng.uniform(0.6, 1.05) * rng.uniform(0.9, 1.08, 3).astype(np.float32)
        pane[:cover] = tone + folds.astype(np.float32)[None, :, None]
    elif choice < 0.6:
        cover = int(pane.shape[0] * rng.uniform(0.2, 0.7))
        slats = np.where(np.arange(cover) % 6 < 2, -50.0, 0.0).astype(np.float32)
        pane[:cover] = _CURTAIN * np.float32(rng.uniform(0.7, 1.05)) + slats[:, None, None]
    if choice > 0.8:
        for _ in range(7):
            at = (int(rng.integers(x0 + 4, x1 - 3)), y1 - int(rng.integers(4, 20)))
            paint = tuple(rng.uniform(30.0, 220.0, 3).tolist())
            cv2.circle(canvas, at, int(rng.integers(3, 7)), paint, -1)


def paint_window(rng: np.random.Generator, canvas: Floats32, box: Box, kind: str, frame: Colour) -> None:
    """A window of one `kind`: cross, sash, shutters, arched or band; sill below, lintel above."""
    x0, y0, x1, y1 = box
    border = 6.0
    if kind == "shutters":
        wide = 0.42 * (x1 - x0)
        for low, high in ((x0 - wide - border, x0 - border), (x1 + border, x1 + wide + border)):
            fill(canvas, (low, y0, high, y1), toned(frame, 0.6))
            for y in np.arange(y0 + 5, y1 - 3, 8):
                cv2.line(canvas, (int(low) + 3, int(y)), (int(high) - 3, int(y)), toned(frame, 0.36), 2)
    trim = (188.0, 192.0, 194.0)
    if kind == "arched":
        middle, half = (round(0.5 * (x0 + x1)), round(y0)), round(0.5 * (x1 - x0))
        cv2.ellipse(canvas, middle, (half + 13, round(0.55 * half) + 13), 0, 180, 360, trim, -1)
        cv2.ellipse(canvas, middle, (half, round(0.55 * half)), 0, 180, 360, (60.0, 56.0, 52.0), -1)
    else:
        fill(canvas, (x0 - 14, y0 - 22, x1 + 14, y0 - 9), toned(trim, float(rng.uniform(0.75, 1.05))))
    fill(canvas, (x0 - border, y0 - border, x1 + border, y1 + border), frame)
    paint_glass(rng, canvas, (x0, y0, x1, y1))
    uprights = {"band": 4, "sash": 1, "arched": 2}.get(kind, 2)
    for k in range(1, uprights):
        x = round(x0 + (x1 - x0) * k / uprights)
        cv2.line(canvas, (x, round(y0)), (x, round(y1)), frame, 5)
    shares = {"cross": (0.33,), "sash": (0.5, 0.25), "arched": (0.3, 0.65)}.get(kind, ())
    for share in shares:
        y = round(y0 + share * (y1 - y0))
        cv2.line(canvas, (round(x0), y), (round(x1), y), frame, 4)
    fill(canvas, (x0 - 13, y1 + border, x1 + 13, y1 + border + 8), trim)
    fill(canvas, (x0 - 13, y1 + border + 9, x1 + 13, y1 + border + 15), (46.0, 48.0, 52.0))


def paint_door(rng: np.random.Generator, canvas: Floats32, box: Box, frame: Colour) -> None:
    """A house door with panels, a step, a lamp and a letter box."""
    x0, y0, x1, y1 = box
    fill(canvas, (x0 - 12, y0 - 12, x1 + 12, y1), frame)
    blue, green, red = rng.uniform(25.0, 160.0, 3).tolist()
    leaf: Colour = (blue, green, red)
    fill(canvas, (x0, y0, x1, y1), leaf)
    for row in range(3):
        for column in range(2):
            px = x0 + (0.12 + 0.43 * column) * (x1 - x0)
            py = y0 + (0.06 + 0.31 * row) * (y1 - y0)
            panel = (px, py, px + 0.33 * (x1 - x0), py + 0.23 * (y1 - y0))
            if row == 0:
                paint_glass(rng, canvas, panel)
            fill(canvas, panel, toned(leaf, 0.55), 3)
    cv2.circle(canvas, (round(x1) - 10, round(0.5 * (y0 + y1))), 4, (60.0, 190.0, 210.0), -1)
    fill(canvas, (x0 - 26, y0 - 30, x1 + 26, y0 - 16), (70.0, 74.0, 80.0))
    fill(canvas, (x1 + 20, y0 + 46, x1 + 44, y0 + 64), (40.0, 44.0, 170.0))
    fill(canvas, (x0 - 14, y1 - 12, x1 + 14, y1), (132.0, 134.0, 138.0))
