# SPDX-License-Identifier: Apache-2.0
"""Painted textures of cars: sides with windows and seams, both ends, lamps, plates, wheels."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.painting.surfaces import Colour, Floats32, Image, coloured, noise, to_image
from services.simulator.shapes.vehicles.cars import BELT_M, SIDE_HEIGHT_M, SIDE_LENGTH_M, WHEEL_RADIUS_M, BodyStyle

Floats = NDArray[np.float64]

_SIDE_PX = (512, 256)


def _side_px(points: Floats) -> NDArray[np.int32]:
    width, height = _SIDE_PX
    x = (points[:, 0] / SIDE_LENGTH_M + 0.5) * width
    y = (1.0 - points[:, 1] / SIDE_HEIGHT_M) * height
    return np.round(np.column_stack([x, y])).astype(np.int32)


def paint_side(rng: np.random.Generator, style: BodyStyle) -> Image:
    """Side of a car in light grey, tinted later: windows, pillars, door seams, handles, wheel arches, sill."""
    width, height = _SIDE_PX
    canvas = _sheet(rng, height, width)
    outline = np.array(style.outline)
    cabin = outline[outline[:, 1] > BELT_M + 0.02]
    middle = np.array([cabin[:, 0].mean(), 0.5 * (BELT_M + cabin[:, 1].max())])
    window = middle + (cabin - middle) * [0.88, 0.72]
    window = np.vstack([window, [window[-1, 0] + 0.1, BELT_M + 0.06], [window[0, 0] - 0.06, BELT_M + 0.06]])
    window[:, 1] = np.maximum(window[:, 1], BELT_M + 0.05)
    mask = np.zeros((height, width), np.uint8)
    cv2.fillPoly(mask, [_side_px(window)], 1)
    glass = coloured(noise(rng, height, width, [(6, 24), (18, 16)]), (62.0, 58.0, 54.0))
    canvas[mask > 0] = glass[mask > 0]
    cv2.polylines(canvas, [_side_px(window)], True, (24.0, 24.0, 24.0), 2)
    for x in (-0.62, 0.28) if style.name != "van" else (0.35,):
        post = np.array([[x, 0.36], [x, BELT_M], [x - 0.12, cabin[:, 1].max()]])
        cv2.polylines(canvas, [_side_px(post[:2])], False, (70.0, 70.0, 70.0), 2)
        cv2.polylines(canvas, [_side_px(post[1:])], False, (120.0, 120.0, 120.0), 7)
        handle = _side_px(np.array([[x + 0.1, 0.90], [x + 0.28, 0.86]]))
        cv2.rectangle(canvas, handle[0].tolist(), handle[1].tolist(), (60.0, 60.0, 60.0), -1)
    crease = _side_px(np.array([[outline[0, 0], 0.72], [outline[-1, 0], 0.70]]))
    cv2.line(canvas, crease[0].tolist(), crease[1].tolist(), (140.0, 140.0, 140.0), 2)
    sill = _side_px(np.array([[-2.5, 0.38], [2.5, 0.0]]))
    cv2.rectangle(canvas, sill[0].tolist(), sill[1].tolist(), (44.0, 44.0, 44.0), -1)
    for x in style.axles_m:
        arch = _side_px(np.array([[x, WHEEL_RADIUS_M]]))[0]
        cv2.circle(canvas, arch.tolist(), round(0.42 / SIDE_LENGTH_M * width), (22.0, 22.0, 22.0), -1)
    return to_image(canvas)


def _sheet(rng: np.random.Generator, height: int, width: int) -> Floats32:
    """Painted metal: sky mirrored above, street below, dust."""
    shine = np.interp(np.linspace(0, 1, height), [0, 0.45, 0.55, 1], [232, 236, 196, 150]).astype(np.float32)
    value = noise(rng, height, width, [(5, 7), (14, 6), (60, 5), (160, 5)])
    return coloured(value, (1.0, 1.0, 1.0)) - 1.0 + shine[:, None, None]


def paint_parts(rng: np.random.Generator) -> dict[str, Image]:
    """The parts every car shares: glass, panels, both ends, plate, wheel, rubber."""
    glass = coloured(noise(rng, 128, 128, [(3, 26), (9, 22), (24, 10)]), (96.0, 88.0, 80.0))
    cv2.line(glass, (18, 118), (70, 96), (18.0, 18.0, 18.0), 3)
    cv2.rectangle(glass, (54, 14), (74, 22), (24.0, 24.0, 26.0), -1)
    for x in (38, 90):
        cv2.ellipse(glass, (x, 92), (13, 30), 0, 180, 360, (34.0, 34.0, 38.0), -1)
    return {
        "car_glass": to_image(glass),
        "car_panel": to_image(_sheet(rng, 64, 64) + 14.0),
        "car_front": _front(rng),
        "car_rear": _rear(rng),
        "plate": _plate(rng),
        "headlamp": _lamp(rng, (232.0, 236.0, 238.0)),
        "tail_lamp": _lamp(rng, (40.0, 36.0, 200.0)),
        "wheel": _wheel(rng),
        "rubber": to_image(coloured(noise(rng, 32, 32, [(8, 6)]), (30.0, 30.0, 30.0))),
    }


def _front(rng: np.random.Generator) -> Image:
    canvas = _sheet(rng, 128, 256)
    cv2.rectangle(canvas, (76, 26), (180, 58), (26.0, 26.0, 26.0), -1)
    for y in range(30, 58, 7):
        cv2.line(canvas, (78, y), (178, y), (120.0, 120.0, 120.0), 2)
    cv2.circle(canvas, (128, 40), 9, (210.0, 210.0, 210.0), -1)
    for x in (36, 220):
        cv2.circle(canvas, (x, 92), 9, (226.0, 228.0, 228.0), -1)
    cv2.rectangle(canvas, (60, 78), (196, 104), (34.0, 34.0, 34.0), -1)
    cv2.line(canvas, (0, 68), (255, 68), (90.0, 90.0, 90.0), 3)
    return to_image(canvas)


def _rear(rng: np.random.Generator) -> Image:
    canvas = _sheet(rng, 128, 256)
    cv2.circle(canvas, (128, 24), 8, (210.0, 210.0, 210.0), -1)
    cv2.rectangle(canvas, (84, 36), (172, 62), (92.0, 92.0, 92.0), 2)
    cv2.line(canvas, (0, 72), (255, 72), (84.0, 84.0, 84.0), 3)
    cv2.rectangle(canvas, (20, 100), (236, 127), (40.0, 40.0, 40.0), -1)
    return to_image(canvas)


def _lamp(rng: np.random.Generator, colour: Colour) -> Image:
    lamp = coloured(noise(rng, 32, 64, [(6, 22), (16, 14)]), colour)
    cv2.circle(lamp, (20, 16), 9, (250.0, 250.0, 250.0), 2)
    cv2.rectangle(lamp, (0, 0), (63, 31), (24.0, 24.0, 24.0), 3)
    return to_image(lamp)


def _plate(rng: np.random.Generator) -> Image:
    plate = np.full((32, 128, 3), 238, np.uint8)
    cv2.rectangle(plate, (0, 0), (12, 31), (160.0, 60.0, 20.0), -1)
    text = "".join(chr(int(c)) for c in rng.integers(65, 91, 3)) + str(int(rng.integers(100, 1000)))
    cv2.putText(plate, text, (16, 25), cv2.FONT_HERSHEY_SIMPLEX, 0.85, (16.0, 16.0, 16.0), 2)
    cv2.rectangle(plate, (0, 0), (127, 31), (16.0, 16.0, 16.0), 1)
    return plate


def _wheel(rng: np.random.Generator) -> Image:
    """Tyre and rim, with the hub in the middle."""
    canvas = coloured(noise(rng, 128, 128, [(20, 6)]), (28.0, 28.0, 28.0))
    dark: Colour = (60.0, 60.0, 60.0)
    cv2.circle(canvas, (64, 64), 44, (172.0, 172.0, 172.0), -1)
    for k in range(5):
        angle = 2.0 * np.pi * (k + 0.5) / 5.0
        hole = (round(64 + 27 * np.cos(angle)), round(64 + 27 * np.sin(angle)))
        cv2.circle(canvas, hole, 11, dark, -1)
    cv2.circle(canvas, (64, 64), 8, (96.0, 96.0, 96.0), -1)
    return to_image(canvas)
