# SPDX-License-Identifier: Apache-2.0
"""Cars: shapes from a side outline. Windows, seams, wheels, lamps and plates are painted in `vehicle_textures`.

Object frame: x forward, y left, z up, origin on the ground below the middle; metres.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.meshes import Mesh, Tint, box, merged, quads, tube

Floats = NDArray[np.float64]

SIDE_LENGTH_M, SIDE_HEIGHT_M = 5.0, 2.5
WHEEL_RADIUS_M = 0.33
BELT_M = 1.0


@dataclass(frozen=True, slots=True)
class BodyStyle:
    """Outline of a car seen from its left, (x, z) in metres from the rear bumper over the roof to the front one.

    rear_glass and windscreen: numbers of the outline's pieces that are glass. headlamp_m: height of their middle.
    """

    name: str
    outline: tuple[tuple[float, float], ...]
    half_width_m: float
    rear_glass: int
    windscreen: int
    axles_m: tuple[float, float]
    headlamp_m: float = 0.68

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


def car_mesh(style: BodyStyle, paint: Tint, texture: Mapping[str, int], glass: str = "car_glass") -> Mesh:
    """A car of one body style and paint (factors of blue, green, red); glass: texture of windscreen and rear window."""
    outline = np.array(style.outline)
    left = np.column_stack([outline[:, 0], _half_width(style, outline[:, 1]), outline[:, 1]])
    right = left * [1.0, -1.0, 1.0]
    pieces = [_side(style, left, 1.0, paint, texture), _side(style, right, -1.0, paint, texture)]
    last = len(outline) - 2
    rear_x, front_x = outline[:, 0].min(), outline[:, 0].max()
    for k in range(len(outline) - 1):
        corners = np.stack([left[k + 1], right[k + 1], right[k], left[k]])
        if k in (style.rear_glass, style.windscreen):
            pieces.append(quads(corners, _UNIT, texture[glass]))
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
            hub = np.array([x, y * (style.half_width_m - 0.2), WHEEL_RADIUS_M])
            rim = np.array([x, y * (style.half_width_m + 0.02), WHEEL_RADIUS_M])
            pieces.append(tube(hub, rim, (WHEEL_RADIUS_M, WHEEL_RADIUS_M), texture["wheel"], 12, repeat=(6.0, 0.05)))
    for end, z, lamp_z in ((rear_x - 0.03, 0.66, 0.84), (front_x + 0.03, 0.42, style.headlamp_m)):
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
    return style.half_width_m * np.interp(z, [0.25, 0.55, BELT_M, roof], [0.95, 1.0, 0.98, 1.0 - lean])


def _side(style: BodyStyle, rim: Floats, y_sign: float, paint: Tint, texture: Mapping[str, int]) -> Mesh:
    """Fan of the outline round a point at the belt line."""
    centre = np.array([0.0, y_sign * style.half_width_m, 0.75])
    ring = np.concatenate([rim, rim[:1]])
    corners = np.stack([np.broadcast_to(centre, (len(rim), 3)), ring[:-1], ring[1:], ring[1:]], axis=1)
    uv = np.stack([corners[..., 0] / SIDE_LENGTH_M + 0.5, 1.0 - corners[..., 2] / SIDE_HEIGHT_M], axis=-1)
    return quads(corners, uv, texture[f"side_{style.name}"], paint, one_part=True)
