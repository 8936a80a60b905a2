# SPDX-License-Identifier: Apache-2.0
"""What stands in an office. Object frame: x forward (the side that faces a person), y left, z up; metres."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from services.simulator.shapes.meshes import Mesh, blob, box, merged, quads, tube

CHAIR_SIZE_M = (0.56, 0.56, 0.98)
SCREEN_SIZE_M = (0.18, 0.56, 0.44)
DESK_SIZE_M = (0.75, 1.5, 0.74)
_FACE_UV = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def front(size: tuple[float, float], x: float, bottom: float, texture: int) -> Mesh:
    """An upright sheet of `size` (width, height) in the plane x, seen from +x with its texture upright."""
    half, top = 0.5 * size[0], bottom + size[1]
    corners = [[x, -half, top], [x, half, top], [x, half, bottom], [x, -half, bottom]]
    return quads([corners], _FACE_UV, texture)


def desk_mesh(texture: Mapping[str, int]) -> Mesh:
    """A table on four legs with drawers."""
    depth, width, height = DESK_SIZE_M
    pieces = [box((depth, width, 0.03), (0, 0, height - 0.015), texture["wood"], 0.8)]
    for x in (-0.5 * depth + 0.05, 0.5 * depth - 0.05):
        for y in (-0.5 * width + 0.05, 0.5 * width - 0.05):
            pieces.append(tube((x, y, 0), (x, y, height - 0.03), (0.022, 0.022), texture["steel"], 6))
    pieces.append(box((0.55, 0.4, 0.55), (-0.05, -0.45, 0.32), texture["plastic"], 0.6))
    return merged(pieces)


def screen_mesh(kind: int, texture: Mapping[str, int]) -> Mesh:
    """A monitor on its foot; the picture looks along +x."""
    depth, width, height = SCREEN_SIZE_M
    body = box((0.03, width, 0.34), (0.0, 0, height - 0.17), texture["dark"], 0.3)
    stand = tube((-0.03, 0, 0.02), (-0.02, 0, height - 0.2), (0.025, 0.02), texture["dark"], 6)
    foot = box((depth, 0.24, 0.015), (0, 0, 0.0075), texture["dark"], 0.3)
    picture = front((width - 0.03, 0.31), 0.016, height - 0.325, texture[f"screen_{kind}"])
    return merged([body, stand, foot, picture])


def chair_mesh(texture: Mapping[str, int], tint: tuple[float, float, float]) -> Mesh:
    """An office chair on a star of five feet; whoever sits on it looks along +x."""
    cloth, dark = texture["fabric"], texture["dark"]
    seat = box((0.46, 0.46, 0.08), (0.0, 0, 0.47), cloth, 0.3, tint)
    back = box((0.07, 0.42, 0.46), (-0.22, 0, 0.75), cloth, 0.3, tint)
    pieces = [seat, back, tube((0, 0, 0.1), (0, 0, 0.44), (0.03, 0.03), dark, 6)]
    for angle in 2.0 * np.pi * np.arange(5) / 5.0:
        end = (0.26 * np.cos(angle), 0.26 * np.sin(angle), 0.04)
        pieces.append(tube((0, 0, 0.09), end, (0.025, 0.02), dark, 5))
    return merged(pieces)


def plant_mesh(rng: np.random.Generator, texture: Mapping[str, int]) -> Mesh:
    """A pot plant of man's height."""
    height = float(rng.uniform(1.1, 1.7))
    pieces = [tube((0, 0, 0), (0, 0, 0.36), (0.17, 0.22), texture["pot"], 10, repeat=(2.0, 1.0))]
    pieces.append(tube((0, 0, 0.3), (0.03, 0, height - 0.3), (0.03, 0.02), texture["wood"], 6))
    for _ in range(5):
        centre = np.array([0.0, 0.0, height - 0.35]) + rng.normal(0.0, [0.14, 0.14, 0.2])
        pieces.append(blob(centre.tolist(), (0.28, 0.28, 0.24), texture["plant"], rng, sides=8))
    return merged(pieces)


def cabinet_mesh(size: tuple[float, float, float], face: int, body: int) -> Mesh:
    """A box of `size` (depth, width, height) with a picture on its front, its back in the plane x = 0."""
    depth, width, height = size
    return merged(
        [box(size, (0.5 * depth, 0, 0.5 * height), body, 1.0), front((width, height), depth + 0.004, 0, face)]
    )


def extinguisher_mesh(texture: Mapping[str, int]) -> Mesh:
    """On a hook at the wall x = 0."""
    bottle = tube((0.08, 0, 0.55), (0.08, 0, 0.98), (0.065, 0.065), texture["red"], 8)
    return merged([bottle, tube((0.08, 0, 0.98), (0.09, 0, 1.06), (0.03, 0.02), texture["dark"], 6)])


def bin_mesh(texture: Mapping[str, int]) -> Mesh:
    """A waste-paper bin."""
    return tube((0, 0, 0), (0, 0, 0.36), (0.12, 0.16), texture["steel"], 10, repeat=(3.0, 1.0))
