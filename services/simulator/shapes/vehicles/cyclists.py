# SPDX-License-Identifier: Apache-2.0
"""Bicycles and those who ride them. Object frame of both: the bicycle's, x forward, y left, z up, on the ground."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.meshes import Mesh, Tint, blob, box, merged, surface, tube
from services.simulator.shapes.people import Gait
from services.simulator.shapes.townspeople import Clothes

_WHEEL_M, _HALF_BASE_M = 0.34, 0.53
_RIDER_SIZE_M = (1.0, 0.56)
_HIP = (-0.2, 0.98)
_PEDAL_M = 5.0
"""Way of one turn of the pedals."""


def bicycle_mesh(paint: Tint, texture: Mapping[str, int]) -> Mesh:
    """A bicycle without its rider."""
    metal, rubber = texture["car_panel"], texture["rubber"]
    pieces = [_wheel(x, texture) for x in (-_HALF_BASE_M, _HALF_BASE_M)]
    head, crank, seat, rear = (0.4, 0.86), (-0.08, 0.3), (-0.24, 0.86), (-_HALF_BASE_M, _WHEEL_M)
    front = (_HALF_BASE_M, _WHEEL_M)
    for a, b in ((head, crank), (head, seat), (seat, crank), (crank, rear), (seat, rear), (head, front)):
        pieces.append(
            tube((a[0], 0, a[1]), (b[0], 0, b[1]), (0.022, 0.022), metal, 4, tint=paint, repeat=(1, 2), caps=False)
        )
    bar = ((0.36, -0.29, 1.04), (0.36, 0.29, 1.04))
    pieces.append(tube((0.4, 0, 0.84), (0.36, 0, 1.05), (0.02, 0.02), metal, 4, caps=False))
    pieces.append(tube(*bar, (0.018, 0.018), rubber, 4, caps=False))
    pieces.append(box((0.26, 0.15, 0.06), (-0.27, 0.0, 0.92), rubber))
    pieces.append(box((0.06, 0.07, 0.06), (-0.62, 0.0, 0.72), texture["tail_lamp"]))
    pieces.append(box((0.34, 0.16, 0.02), (-0.52, 0.0, 0.72), metal))
    return merged(pieces)


def rider_mesh(clothes: Clothes, texture: Mapping[str, int]) -> tuple[Mesh, Gait, tuple[float, float, float]]:
    """Who sits on a bicycle, how the legs turn, and length, width, height of the cuboid from the ground up."""
    pieces: list[tuple[Mesh, float]] = []
    hip_x, hip_z = _HIP
    top, legs, skin = texture[clothes.top], texture[clothes.legs], texture["skin_tinted"]
    for side in (-1.0, 1.0):
        y = 0.11 * side
        knee = (hip_x + 0.4, y, hip_z - 0.14 - 0.1 * side)
        foot = (hip_x + 0.2, y * 1.2, 0.34 - 0.1 * side)
        swing = 0.16 * side
        thigh = tube((hip_x, y, hip_z), knee, (0.085, 0.065), legs, 6, tint=clothes.legs_tint, caps=False)
        shin = tube(knee, foot, (0.06, 0.045), legs, 6, tint=clothes.legs_tint, caps=False)
        shoe = box((0.26, 0.09, 0.08), (foot[0] + 0.06, foot[1], foot[2] - 0.02), texture["rubber"])
        pieces += [(thigh, swing), (shin, swing), (shoe, swing)]
        elbow, hand = (0.1, 0.25 * side, 1.2), (0.34, 0.24 * side, 1.07)
        upper = tube((-0.02, 0.19 * side, 1.44), elbow, (0.055, 0.045), top, 5, tint=clothes.top_tint, caps=False)
        lower = tube(elbow, hand, (0.045, 0.035), top, 5, tint=clothes.top_tint, caps=False)
        pieces += [(upper, 0.0), (lower, 0.0)]
    trunk = tube((hip_x, 0, hip_z - 0.04), (0.0, 0, 1.5), (0.17, 0.19), top, 8, tint=clothes.top_tint, repeat=(2, 1))
    neck = tube((0.0, 0, 1.48), (0.05, 0, 1.58), (0.055, 0.055), skin, 5, tint=clothes.skin_tint, caps=False)
    head = blob((0.08, 0, 1.66), (0.105, 0.085, 0.13), texture[clothes.face], sides=8, repeat=(1, 1))
    pieces += [(trunk, 0.0), (neck, 0.0), (head, 0.0)]
    if clothes.bag:
        pieces.append((box((0.14, 0.28, 0.4), (-0.27, 0, 1.3), texture["bag"]), 0.0))
    if clothes.hat:
        helmet = blob((0.07, 0, 1.74), (0.14, 0.1, 0.075), texture["car_panel"], sides=6, tint=clothes.top_tint)
        pieces.append((helmet, 0.0))
    mesh = merged([piece for piece, _ in pieces])
    amplitude = np.concatenate([np.full(len(piece.vertices), angle) for piece, angle in pieces])
    gait = Gait(np.full(len(mesh.vertices), hip_z), amplitude, np.full(len(mesh.vertices), hip_x), _PEDAL_M)
    return mesh, gait, (*_RIDER_SIZE_M, 1.8)


def _wheel(x_m: float, texture: Mapping[str, int]) -> Mesh:
    """A tyre as a band and a ring, and four spokes."""
    angle = np.linspace(0.0, 2.0 * np.pi, 13)

    def ring(radius_m: float, y: float) -> NDArray[np.float64]:
        z = _WHEEL_M + radius_m * np.sin(angle)
        return np.column_stack([x_m + radius_m * np.cos(angle), np.full_like(angle, y), z])

    uv = np.stack(np.broadcast_arrays(0.5 * np.arange(13.0)[None, :], np.array([[0.0], [0.1]])), axis=-1)
    tread = surface(np.stack([ring(_WHEEL_M, -0.025), ring(_WHEEL_M, 0.025)]), uv, texture["rubber"])
    wall = surface(np.stack([ring(_WHEEL_M - 0.05, 0.0), ring(_WHEEL_M, 0.0)]), uv, texture["rubber"])
    spokes = []
    for turn in (0.3, 1.87):
        reach = np.array([np.cos(turn), 0.0, np.sin(turn)]) * (_WHEEL_M - 0.03)
        centre = np.array([x_m, 0.0, _WHEEL_M])
        spokes.append(tube(centre - reach, centre + reach, (0.008, 0.008), texture["metal"], 3, caps=False))
    return merged([tread, wall, *spokes])
