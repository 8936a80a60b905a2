# SPDX-License-Identifier: Apache-2.0
"""Cars: shapes from a side outline, and the textures that give them windows, seams, wheels, lights and plates.

Object frame: x forward, y left, z up, origin on the ground below the middle; metres.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.meshes import Mesh, Tint, box, merged, quads, tube
from services.simulator.surfaces import Colour, Floats32, Image, coloured, noise, to_image

Floats = NDArray[np.float64]

SIDE_LENGTH_M, SIDE_HEIGHT_M = 5.0, 2.5
_SIDE_PX = (512, 256)
_WHEEL_RADIUS_M = 0.33
_BELT_M = 1.0


@dataclass(frozen=True, slots=True)
class BodyStyle:
    """Outline of a car seen from its left, (x, z) in metres from the rear bumper over the roof to the front one.

    rear_glass and windscreen: numbers of the outline's pieces that are glass.
    """

    name: str
    outline: tuple[tuple[float, float], ...]
    half_width_m: float
    rear_glass: int
    windscreen: int
    axles_m: tuple[float, float]

    @property
    def size_m(self) -> tuple[float, float, float]:
        """Length, width, height."""
        x, z = zip(*self.outline, strict=True)
        return (max(x) - min(x), 2.0 * self.half_width_m, max(z))


STYLES = (
    BodyStyle(
        "saloon",
        (
            (-2.18, 0.30),
            (-2.24, 0.62),
            (-2.16, 0.97),
            (-1.62, 1.04),
            (-0.95, 1.42),
            (0.25, 1.46),
            (1.08, 1.02),
            (1.98, 0.84),
            (2.2, 0.6),
            (2.16, 0.28),
        ),
        0.89,
        3,
        5,
        (-1.36, 1.36),
    ),
    BodyStyle(
        "hatchback",
        (
            (-1.88, 0.30),
            (-1.96, 0.62),
            (-1.94, 1.0),
            (-1.62, 1.44),
            (-0.3, 1.52),
            (0.3, 1.49),
            (1.02, 1.04),
            (1.72, 0.88),
            (1.94, 0.62),
            (1.9, 0.28),
        ),
        0.86,
        2,
        5,
        (-1.2, 1.24),
    ),
    BodyStyle(
        "van",
        (
            (-2.3, 0.32),
            (-2.36, 0.7),
            (-2.36, 1.1),
            (-2.26, 1.98),
            (-0.5, 2.06),
            (1.1, 1.98),
            (1.78, 1.16),
            (2.2, 0.98),
            (2.34, 0.66),
            (2.3, 0.3),
        ),
        0.97,
        2,
        5,
        (-1.45, 1.5),
    ),
)

PAINTS: tuple[Tint, ...] = (
    (0.92, 0.92, 0.92),
    (0.28, 0.28, 0.30),
    (0.62, 0.62, 0.60),
    (0.22, 0.20, 0.78),
    (0.72, 0.36, 0.18),
    (0.20, 0.42, 0.24),
    (0.30, 0.66, 0.86),
    (0.46, 0.24, 0.16),
)


def car_mesh(style: BodyStyle, paint: Tint, texture: Mapping[str, int]) -> Mesh:
    """A car of one body style and paint (factors of blue, green, red)."""
    outline = np.array(style.outline)
    left = np.column_stack([outline[:, 0], _half_width(style, outline[:, 1]), outline[:, 1]])
    right = left * [1.0, -1.0, 1.0]
    pieces = [_side(style, left, 1.0, paint, texture), _side(style, right, -1.0, paint, texture)]
    last = len(outline) - 2
    rear_x, front_x = outline[:, 0].min(), outline[:, 0].max()
    for k in range(len(outline) - 1):
        corners = np.stack([left[k + 1], right[k + 1], right[k], left[k]])
        if k in (style.rear_glass, style.windscreen):
            pieces.append(quads(corners, _UNIT, texture["car_glass"]))
        elif k in (0, 1):
            pieces.append(quads(corners, _half(k == 1), texture["car_rear"], paint))
        elif k in (last, last - 1):
            pieces.append(quads(corners[::-1], _half(k == last - 1), texture["car_front"], paint))
        else:
            pieces.append(quads(corners, _UNIT, texture["car_panel"], paint))
    ends = np.stack([left[-1], right[-1], right[0], left[0]])
    pieces.append(quads(ends, _UNIT, texture["rubber"]))
    for x in style.axles_m:
        for y in (-1.0, 1.0):
            hub = np.array([x, y * (style.half_width_m - 0.2), _WHEEL_RADIUS_M])
            rim = np.array([x, y * (style.half_width_m + 0.02), _WHEEL_RADIUS_M])
            pieces.append(tube(hub, rim, (_WHEEL_RADIUS_M, _WHEEL_RADIUS_M), texture["wheel"], 12, repeat=(6.0, 0.05)))
    for end, z, lamp_z in ((rear_x - 0.03, 0.66, 0.84), (front_x + 0.03, 0.42, 0.68)):
        across = np.array([0.27, -0.27, -0.27, 0.27])
        plate = np.column_stack(
            [np.full(4, end), across if end < 0 else -across, z + np.array([0.06, 0.06, -0.06, -0.06])]
        )
        pieces.append(quads(plate, _UNIT, texture["plate"]))
        # Lamps keep their colours whatever the paint.
        for side in (-1.0, 1.0):
            lamp = plate * [1.0, 0.8, 1.0] + [0.0, side * (style.half_width_m - 0.24), lamp_z - z]
            pieces.append(quads(lamp, _UNIT, texture["headlamp" if end > 0 else "tail_lamp"]))
    mirror_x = outline[style.windscreen + 1, 0] - 0.18
    for y in (-1.0, 1.0):
        centre = (mirror_x, y * (style.half_width_m + 0.1), outline[style.windscreen + 1, 1] + 0.02)
        pieces.append(box((0.12, 0.2, 0.14), centre, texture["car_panel"], tint=paint))
    return merged(pieces)


_UNIT = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def _half(upper: bool) -> Floats:
    return _UNIT * [1.0, 0.5] + [0.0, 0.0 if upper else 0.5]


def _half_width(style: BodyStyle, z: Floats) -> Floats:
    """The body bulges up to the belt line and leans inwards above it."""
    roof = style.size_m[2]
    lean = 0.30 if roof < 1.7 else 0.14
    return style.half_width_m * np.interp(z, [0.25, 0.55, _BELT_M, roof], [0.95, 1.0, 0.98, 1.0 - lean])


def _side(style: BodyStyle, rim: Floats, y_sign: float, paint: Tint, texture: Mapping[str, int]) -> Mesh:
    """Fan of the outline round a point at the belt line."""
    centre = np.array([0.0, y_sign * style.half_width_m, 0.75])
    ring = np.concatenate([rim, rim[:1]])
    corners = np.stack([np.broadcast_to(centre, (len(rim), 3)), ring[:-1], ring[1:], ring[1:]], axis=1)
    uv = np.stack([corners[..., 0] / SIDE_LENGTH_M + 0.5, 1.0 - corners[..., 2] / SIDE_HEIGHT_M], axis=-1)
    return quads(corners, uv, texture[f"side_{style.name}"], paint, one_part=True)


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
    cabin = outline[outline[:, 1] > _BELT_M + 0.02]
    middle = np.array([cabin[:, 0].mean(), 0.5 * (_BELT_M + cabin[:, 1].max())])
    window = middle + (cabin - middle) * [0.88, 0.72]
    window = np.vstack([window, [window[-1, 0] + 0.1, _BELT_M + 0.06], [window[0, 0] - 0.06, _BELT_M + 0.06]])
    window[:, 1] = np.maximum(window[:, 1], _BELT_M + 0.05)
    mask = np.zeros((height, width), np.uint8)
    cv2.fillPoly(mask, [_side_px(window)], 1)
    glass = coloured(noise(rng, height, width, [(6, 24), (18, 16)]), (62.0, 58.0, 54.0))
    canvas[mask > 0] = glass[mask > 0]
    cv2.polylines(canvas, [_side_px(window)], True, (24.0, 24.0, 24.0), 2)
    for x in (-0.62, 0.28) if style.name != "van" else (0.35,):
        post = np.array([[x, 0.36], [x, _BELT_M], [x - 0.12, cabin[:, 1].max()]])
        cv2.polylines(canvas, [_side_px(post[:2])], False, (70.0, 70.0, 70.0), 2)
        cv2.polylines(canvas, [_side_px(post[1:])], False, (120.0, 120.0, 120.0), 7)
        handle = _side_px(np.array([[x + 0.1, 0.90], [x + 0.28, 0.86]]))
        cv2.rectangle(canvas, handle[0].tolist(), handle[1].tolist(), (60.0, 60.0, 60.0), -1)
    crease = _side_px(np.array([[outline[0, 0], 0.72], [outline[-1, 0], 0.70]]))
    cv2.line(canvas, crease[0].tolist(), crease[1].tolist(), (140.0, 140.0, 140.0), 2)
    sill = _side_px(np.array([[-2.5, 0.38], [2.5, 0.0]]))
    cv2.rectangle(canvas, sill[0].tolist(), sill[1].tolist(), (44.0, 44.0, 44.0), -1)
    for x in style.axles_m:
        arch = _side_px(np.array([[x, _WHEEL_RADIUS_M]]))[0]
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
