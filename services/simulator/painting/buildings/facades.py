# SPDX-License-Identifier: Apache-2.0
"""Painted fronts of houses: a wall, floors of windows, doors. One tile is 12 m wide and as high as the house."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.painting.surfaces import Colour, Floats32, Image, bricks, noise, planks, plaster, to_image

Floats = NDArray[np.float64]

FACADE_WIDTH_M = 12.0
BAY_M = 3.0
_PX_PER_BAY = 256
_GLASS = np.array([92, 78, 66], np.float32)
_CURTAIN = np.array([196, 202, 206], np.float32)


@dataclass(frozen=True, slots=True)
class FacadeStyle:
    """How a front is painted; `floors` of `floor_m` metres make its height."""

    name: str
    wall: str
    colour: Colour
    frame: Colour
    floors: int
    floor_m: float = 2.9

    @property
    def height_m(self) -> float:
        return self.floors * self.floor_m + 0.3


STYLES = (
    FacadeStyle("brick_red", "bricks", (70, 84, 148), (225, 228, 230), 2),
    FacadeStyle("brick_yellow", "bricks", (112, 158, 182), (70, 84, 96), 3),
    FacadeStyle("plaster_white", "plaster", (204, 210, 214), (60, 78, 112), 2),
    FacadeStyle("plaster_ochre", "plaster", (112, 168, 206), (232, 234, 236), 3),
    FacadeStyle("plaster_green", "plaster", (150, 176, 162), (228, 230, 230), 2),
    FacadeStyle("wood_brown", "planks", (72, 100, 134), (218, 222, 224), 2),
)


def paint_facade(rng: np.random.Generator, style: FacadeStyle) -> Image:
    """Front of four bays, (512, 1024, 3), row 0 at the eaves; no window crosses a bay's edge."""
    height, width = 512, 4 * _PX_PER_BAY
    if style.wall == "bricks":
        canvas = bricks(rng, style.colour, height, width, rows=int(style.height_m / 0.085 / 1.4))
    elif style.wall == "planks":
        canvas = planks(rng, style.colour, height, width, rows=int(style.height_m / 0.19))
    else:
        canvas = plaster(rng, style.colour, height, width)
    px_per_m = np.array([width / FACADE_WIDTH_M, height / style.height_m])
    door_bay = int(rng.integers(0, 4))
    for floor in range(style.floors):
        base = height - 1 - floor * style.floor_m * px_per_m[1]
        for bay in range(4):
            left = bay * _PX_PER_BAY
            if floor == 0 and bay == door_bay:
                _door(rng, canvas, (left, base), px_per_m, style)
            else:
                _window(rng, canvas, (left, base), px_per_m, style)
        if floor:
            y = int(base)
            cv2.rectangle(canvas, (0, y - 5), (width, y + 4), _toned(style.colour, 0.72), -1)
            cv2.line(canvas, (0, y - 6), (width, y - 6), _toned(style.colour, 1.25), 2)
    canvas[: height // 24] *= 0.62
    canvas[-height // 20 :] *= 0.7
    return to_image(canvas)


def _toned(colour: Colour, factor: float) -> Colour:
    return (colour[0] * factor, colour[1] * factor, colour[2] * factor)


def _rectangle(canvas: Floats32, box: tuple[float, float, float, float], colour: Colour, thickness: int = -1) -> None:
    x0, y0, x1, y1 = (round(v) for v in box)
    cv2.rectangle(canvas, (x0, y0), (x1, y1), colour, thickness)


def _window(
    rng: np.random.Generator, canvas: Floats32, at_px: tuple[float, float], px_per_m: Floats, style: FacadeStyle
) -> None:
    """Frame, mullions, sill and shutters; behind the glass a reflection, a curtain or a blind."""
    left, base = at_px
    width_m, height_m = rng.uniform(1.0, 1.7), rng.uniform(1.25, 1.6)
    middle = left + 0.5 * _PX_PER_BAY + rng.uniform(-12, 12)
    x0, x1 = middle - 0.5 * width_m * px_per_m[0], middle + 0.5 * width_m * px_per_m[0]
    y1 = base - 0.9 * px_per_m[1]
    y0 = y1 - height_m * px_per_m[1]
    frame = 0.07 * px_per_m[0]
    if rng.random() < 0.45:
        for inner, outer in ((x0, x0 - 0.42 * px_per_m[0]), (x1, x1 + 0.42 * px_per_m[0])):
            low, high = sorted((inner, outer))
            _rectangle(canvas, (low, y0, high, y1), _toned(style.frame, 0.55))
            for y in np.arange(y0 + 4, y1 - 2, 7):
                cv2.line(canvas, (int(low) + 3, int(y)), (int(high) - 3, int(y)), _toned(style.frame, 0.32), 2)
    _rectangle(canvas, (x0 - frame, y0 - frame, x1 + frame, y1 + frame), style.frame)
    glass = np.s_[int(y0) : int(y1), int(x0) : int(x1)]
    pane = canvas[glass]
    shine = noise(rng, pane.shape[0], pane.shape[1], [(3, 26.0), (7, 18.0)])
    pane[:] = _GLASS * rng.uniform(0.4, 1.2) + shine[..., None]
    if rng.random() < 0.6:
        cover = int(pane.shape[0] * rng.uniform(0.2, 0.8))
        folds = 18.0 * np.sin(np.arange(pane.shape[1]) * rng.uniform(0.25, 0.6))
        pane[:cover] = _CURTAIN * rng.uniform(0.7, 1.1) + folds.astype(np.float32)[None, :, None]
    for k in range(1, int(rng.integers(2, 4))):
        x = x0 + (x1 - x0) * k / 2.0
        cv2.line(canvas, (int(x), int(y0)), (int(x), int(y1)), style.frame, 5)
    if rng.random() < 0.6:
        y = y0 + rng.uniform(0.3, 0.5) * (y1 - y0)
        cv2.line(canvas, (int(x0), int(y)), (int(x1), int(y)), style.frame, 4)
    _rectangle(canvas, (x0 - 12, y1 + frame, x1 + 12, y1 + frame + 8), (176.0, 178.0, 180.0))
    _rectangle(canvas, (x0 - 12, y1 + frame + 9, x1 + 12, y1 + frame + 14), (46.0, 48.0, 52.0))


def _door(
    rng: np.random.Generator, canvas: Floats32, at_px: tuple[float, float], px_per_m: Floats, style: FacadeStyle
) -> None:
    left, base = at_px
    middle = left + 0.5 * _PX_PER_BAY
    x0, x1 = middle - 0.55 * px_per_m[0], middle + 0.55 * px_per_m[0]
    y0 = base - 2.1 * px_per_m[1]
    _rectangle(canvas, (x0 - 12, y0 - 12, x1 + 12, base), style.frame)
    red, green, blue = rng.uniform(30.0, 150.0, 3).tolist()
    leaf: Colour = (blue, green, red)
    _rectangle(canvas, (x0, y0, x1, base), leaf)
    for row in range(2):
        for column in range(2):
            px = x0 + (0.12 + 0.45 * column) * (x1 - x0)
            py = y0 + (0.1 + 0.45 * row) * (base - y0)
            _rectangle(canvas, (px, py, px + 0.33 * (x1 - x0), py + 0.33 * (base - y0)), _toned(leaf, 0.6), 3)
    cv2.circle(canvas, (round(x1) - 10, round(0.5 * (y0 + base))), 4, (60.0, 190.0, 210.0), -1)
    _rectangle(canvas, (x0 - 30, y0 - 26, x1 + 30, y0 - 14), (70.0, 74.0, 80.0))
    _rectangle(canvas, (x1 + 22, y0 + 40, x1 + 46, y0 + 58), (40.0, 44.0, 170.0))
