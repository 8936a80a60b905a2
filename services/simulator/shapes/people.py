# SPDX-License-Identifier: Apache-2.0
"""People: a body of tubes whose limbs swing with the distance walked.

Object frame: x forward, y left, z up, origin on the ground between the feet; metres.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.painting.surfaces import Image, coloured, noise, to_image
from services.simulator.shapes.meshes import Mesh, blob, merged, quads, tube

PERSON_SIZE_M = (0.6, 0.62, 1.78)
_STRIDE_M = 1.45
_HIP_M, _SHOULDER_M = 0.92, 1.42
_JACKETS = ((60, 50, 170), (150, 90, 40), (70, 130, 70), (60, 170, 205), (190, 190, 190), (60, 60, 66))
JACKET_COUNT = len(_JACKETS)


@dataclass(frozen=True, slots=True)
class Gait:
    """Which vertices belong to which swinging limb.

    pivot_z_m: (V,) height the vertex turns about. amplitude_rad: (V,) largest angle, signed; 0 for head and trunk.
    pivot_x_m: (V,) place along x, or 0 for all. stride_m: way after which it is the same again.
    """

    pivot_z_m: NDArray[np.float64]
    amplitude_rad: NDArray[np.float64]
    pivot_x_m: NDArray[np.float64] | float = 0.0
    stride_m: float = _STRIDE_M

    def swung(self, vertices: NDArray[np.float64], walked_m: float) -> NDArray[np.float64]:
        """Vertices (V, 3) in the object frame after `walked_m` metres."""
        angle = self.amplitude_rad * np.sin(2.0 * np.pi * walked_m / self.stride_m)
        x, z = vertices[:, 0] - self.pivot_x_m, vertices[:, 2] - self.pivot_z_m
        cos, sin = np.cos(angle), np.sin(angle)
        return np.column_stack([x * cos - z * sin + self.pivot_x_m, vertices[:, 1], x * sin + z * cos + self.pivot_z_m])


def person_mesh(jacket: int, height_m: float, texture: Mapping[str, int], with_bag: bool) -> tuple[Mesh, Gait]:
    """A person of `height_m` in jacket number `jacket`, and how the limbs swing."""
    coat, cloth, skin = texture[f"jacket_{jacket}"], texture["jeans"], texture["skin"]
    pieces: list[tuple[Mesh, float, float]] = []
    for side in (-1.0, 1.0):
        thigh = tube((0, 0.1 * side, _HIP_M), (0.01, 0.1 * side, 0.08), (0.1, 0.06), cloth, 7, repeat=(2.0, 2.0))
        shoe = blob((0.06, 0.1 * side, 0.05), (0.15, 0.055, 0.06), texture["rubber"], sides=6)
        arm = tube((0, 0.25 * side, _SHOULDER_M), (0.04, 0.29 * side, 0.86), (0.065, 0.045), coat, 6, repeat=(2.0, 2.0))
        hand = blob((0.05, 0.29 * side, 0.8), (0.05, 0.03, 0.07), skin, sides=6)
        pieces += [(thigh, _HIP_M, 0.42 * side), (shoe, _HIP_M, 0.42 * side)]
        pieces += [(arm, _SHOULDER_M, -0.38 * side), (hand, _SHOULDER_M, -0.38 * side)]
    trunk = blob((0, 0, 1.18), (0.15, 0.245, 0.36), coat, sides=12, repeat=(2.0, 1.0))
    head = blob((0.02, 0, 1.64), (0.1, 0.085, 0.135), texture["face"], sides=10, repeat=(1.0, 1.0))
    neck = tube((0, 0, 1.46), (0.01, 0, 1.56), (0.06, 0.055), skin, 6)
    still = [trunk, head, neck]
    if with_bag:
        still.append(blob((-0.2, 0, 1.22), (0.11, 0.17, 0.24), texture["bag"], sides=8))
    badge = np.array([[0.13, 0.1, 1.3], [0.13, -0.1, 1.3], [0.15, -0.1, 1.12], [0.15, 0.1, 1.12]])
    still.append(quads(badge, [[0, 0], [1, 0], [1, 1], [0, 1]], texture["plate"]))
    pieces += [(mesh, 0.0, 0.0) for mesh in still]
    pivot = np.concatenate([np.full(len(mesh.vertices), z) for mesh, z, _ in pieces])
    amplitude = np.concatenate([np.full(len(mesh.vertices), a) for mesh, _, a in pieces])
    scale = height_m / PERSON_SIZE_M[2]
    body = merged([mesh for mesh, _, _ in pieces]).transformed(np.diag([scale, scale, scale, 1.0]))
    return body, Gait(pivot * scale, amplitude)


def paint_clothes(rng: np.random.Generator) -> dict[str, Image]:
    """Jackets (plain, striped, checked), jeans, skin, face with hair, bag."""
    textures: dict[str, Image] = {}
    for number, colour in enumerate(_JACKETS):
        canvas = coloured(noise(rng, 128, 128, [(5, 16), (14, 20), (50, 14)]), colour)
        period = int(rng.integers(14, 30))
        if number % 3 == 0:
            canvas[np.arange(128) % period < period // 3] *= 0.55
        elif number % 3 == 1:
            canvas[:, np.arange(128) % period < 4] = 0.4 * canvas[:, np.arange(128) % period < 4] + 130.0
            canvas[np.arange(128) % period < 4] = 0.5 * canvas[np.arange(128) % period < 4] + 20.0
        cv2.line(canvas, (32, 0), (32, 127), (24.0, 24.0, 24.0), 3)
        for y in (74, 92):
            cv2.rectangle(canvas, (12, y), (26, y + 10), (30.0, 30.0, 30.0), 2)
        textures[f"jacket_{number}"] = to_image(canvas)
    textures["jeans"] = to_image(coloured(noise(rng, 64, 64, [(4, 22), (12, 22), (32, 12)]), (98.0, 66.0, 48.0)))
    textures["skin"] = to_image(coloured(noise(rng, 32, 32, [(6, 8)]), (140.0, 168.0, 212.0)))
    textures["bag"] = to_image(coloured(noise(rng, 64, 64, [(4, 24), (16, 28)]), (40.0, 60.0, 120.0)))
    face = coloured(noise(rng, 64, 64, [(10, 8)]), (140.0, 168.0, 212.0))
    hair = coloured(noise(rng, 64, 64, [(12, 18)]), (36.0, 50.0, 70.0))
    face[:24], face[:, 16:48] = hair[:24], hair[:, 16:48]
    for x in (4, 60):
        cv2.circle(face, (x, 30), 3, (30.0, 30.0, 30.0), -1)
    textures["face"] = to_image(face)
    return textures
