# SPDX-License-Identifier: Apache-2.0
"""Painted storeys of town houses. One tile is 12 m wide; its upper half is any upper storey, its lower half the ground
floor, each 3 m high, so that houses of any height are put together from it."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from services.simulator.painting.buildings.windows import fill, paint_door, paint_window, toned
from services.simulator.painting.surfaces import (
    Colour,
    Floats32,
    Image,
    bricks,
    coloured,
    noise,
    planks,
    plaster,
    to_image,
)

STOREY_M = 3.0
TILE_M = 12.0
BAYS = 4
PLAIN_M = 3.0
"""Side of the square that a plain wall's texture covers."""
_PX_PER_M = 1024 / TILE_M
_PLAIN_PX = 256


@dataclass(frozen=True, slots=True)
class StoreyStyle:
    """How a house's walls and windows are painted."""

    name: str
    wall: str
    colour: Colour
    frame: Colour
    window: str
    window_m: tuple[float, float] = (1.15, 1.5)


STYLES = (
    StoreyStyle("red_brick", "bricks", (66, 80, 146), (226, 230, 232), "sash"),
    StoreyStyle("dark_clinker", "bricks", (58, 62, 88), (232, 234, 234), "cross"),
    StoreyStyle("yellow_brick", "bricks", (104, 156, 184), (60, 78, 92), "arched", (1.0, 1.6)),
    StoreyStyle("white_plaster", "plaster", (208, 214, 218), (70, 92, 120), "shutters", (1.0, 1.5)),
    StoreyStyle("ochre_plaster", "plaster", (96, 164, 206), (228, 232, 234), "shutters", (1.05, 1.45)),
    StoreyStyle("rose_plaster", "plaster", (150, 156, 204), (238, 240, 240), "cross", (1.3, 1.4)),
    StoreyStyle("blue_plaster", "plaster", (188, 164, 138), (240, 240, 240), "cross"),
    StoreyStyle("green_planks", "planks", (122, 146, 118), (234, 236, 236), "sash"),
    StoreyStyle("half_timbered", "timber", (206, 218, 224), (58, 70, 92), "cross", (1.0, 1.2)),
    StoreyStyle("sandstone", "stone", (138, 172, 192), (90, 96, 104), "arched", (1.1, 1.6)),
    StoreyStyle("grey_panels", "panels", (166, 168, 168), (214, 216, 216), "band", (2.2, 1.4)),
    StoreyStyle("orange_panels", "panels", (128, 160, 200), (80, 84, 88), "band", (2.0, 1.5)),
)


def paint_storeys(rng: np.random.Generator, style: StoreyStyle) -> Image:
    """Both storeys, (512, 1024, 3); no window crosses a bay's edge."""
    canvas = paint_wall(rng, style, 512, 1024)
    half, bay = 256, 256
    door_bay = int(rng.integers(0, BAYS))
    width, height = (value * _PX_PER_M for value in style.window_m)
    for row, base in enumerate((half, 2 * half)):
        for k in range(BAYS):
            middle = (k + 0.5) * bay + float(rng.uniform(-5.0, 5.0))
            if row == 1 and k == door_bay:
                box = (middle - 46.0, base - 2.2 * _PX_PER_M, middle + 46.0, base - 2.0)
                paint_door(rng, canvas, box, style.frame)
                continue
            x0, y1 = middle - 0.5 * width, base - 0.85 * _PX_PER_M
            paint_window(rng, canvas, (x0, y1 - height, x0 + width, y1), style.window, style.frame)
    if style.wall not in ("timber", "panels"):
        fill(canvas, (0, half - 9, 1024, half - 1), toned(style.colour, 0.72))
        fill(canvas, (0, half - 12, 1024, half - 9), toned(style.colour, 1.25))
    canvas[-22:] *= 0.62
    return to_image(canvas)


def paint_plain(rng: np.random.Generator, style: StoreyStyle) -> Image:
    """The wall alone, 3 m square, for gables and walls without windows."""
    return to_image(paint_wall(rng, style, _PLAIN_PX, _PLAIN_PX))


def paint_wall(rng: np.random.Generator, style: StoreyStyle, height: int, width: int) -> Floats32:
    """A wall without openings, as float canvas."""
    metres = height / _PX_PER_M
    if style.wall == "bricks":
        return bricks(rng, style.colour, height, width, rows=round(metres / 0.1))
    if style.wall == "planks":
        return planks(rng, style.colour, height, width, rows=round(metres / 0.2))
    if style.wall == "stone":
        return bricks(rng, style.colour, height, width, rows=round(metres / 0.42))
    canvas = plaster(rng, style.colour, height, width)
    if style.wall == "timber":
        _beams(rng, canvas)
    if style.wall == "panels":
        _panels(rng, canvas, style.colour)
    return canvas


def _beams(rng: np.random.Generator, canvas: Floats32) -> None:
    """Dark beams: a frame round every bay and a slanted brace in some."""
    height, width = canvas.shape[:2]
    grain = noise(rng, height, width, [(160, 14.0)])
    beams = np.zeros((height, width), np.uint8)
    for x in range(0, width + 1, 128):
        cv2.line(beams, (x, 0), (x, height), 1, 17)
    for y in (4, 120, 252, 260, 376, 508):
        cv2.line(beams, (0, y), (width, y), 1, 15)
    for x in range(0, width, 256):
        for y in (0, 256):
            if rng.random() < 0.6:
                cv2.line(beams, (x + 8, y + 250), (x + 62, y + 8), 1, 15)
    canvas[beams > 0] = coloured(grain, (44.0, 56.0, 74.0))[beams > 0]


def _panels(rng: np.random.Generator, canvas: Floats32, colour: Colour) -> None:
    """Concrete slabs of 3 m with dark joints, each of its own tone."""
    height, width = canvas.shape[:2]
    for y in range(0, height, 256):
        for x in range(0, width, 256):
            canvas[y : y + 256, x : x + 256] *= np.float32(rng.uniform(0.9, 1.08))
            fill(canvas, (x, y + 206, x + 256, y + 256), toned(colour, float(rng.uniform(0.55, 0.95))))
    canvas[::256] *= 0.5
    canvas[1::256] *= 0.6
    canvas[:, ::256] *= 0.5
    canvas[:, 1::256] *= 0.6
