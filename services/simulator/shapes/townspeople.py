# SPDX-License-Identifier: Apache-2.0
"""People of the town: several builds, coats, skirts, bags and hats. Object frame as in `people`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from services.simulator.shapes.meshes import Mesh, Tint, blob, box, merged, tube
from services.simulator.shapes.people import Gait

TOPS = ("cloth_plain", "cloth_striped", "cloth_checked", "cloth_knit", "cloth_print")
FACES = 6
_ADULT_M = 1.76
_HIP_M, _SHOULDER_M = 0.9, 1.42
_COLOURS: tuple[Tint, ...] = (
    (0.25, 0.22, 0.85),
    (0.80, 0.42, 0.20),
    (0.35, 0.62, 0.32),
    (0.22, 0.72, 0.95),
    (0.95, 0.95, 0.95),
    (0.22, 0.22, 0.24),
    (0.55, 0.30, 0.60),
    (0.35, 0.45, 0.62),
    (0.75, 0.72, 0.40),
    (0.50, 0.40, 0.85),
    (0.45, 0.30, 0.18),
    (0.25, 0.45, 0.85),
    (0.62, 0.62, 0.60),
    (0.30, 0.34, 0.30),
)
_LEGS: tuple[Tint, ...] = (
    (0.62, 0.42, 0.30),
    (0.22, 0.22, 0.24),
    (0.42, 0.5, 0.58),
    (0.55, 0.55, 0.53),
    (0.30, 0.24, 0.2),
)
_SKINS: tuple[Tint, ...] = ((0.62, 0.76, 0.95), (0.50, 0.64, 0.84), (0.34, 0.45, 0.64), (0.22, 0.30, 0.44))


@dataclass(frozen=True, slots=True)
class Clothes:
    """Who somebody is and wears. Textures by name, tints as factors of blue, green, red. coat: it reaches the knees."""

    height_m: float
    stout: float
    top: str
    top_tint: Tint
    legs: str
    legs_tint: Tint
    skin_tint: Tint
    face: str
    coat: bool
    skirt: bool
    bag: bool
    hat: bool


def draw_clothes(rng: np.random.Generator, *, grown_up: bool = False) -> Clothes:
    """Somebody; every sixth is a child unless `grown_up`."""
    child = not grown_up and rng.random() < 0.16
    woman = rng.random() < 0.5
    height = rng.uniform(1.05, 1.45) if child else rng.uniform(1.55, 1.76) if woman else rng.uniform(1.66, 1.94)
    face = int(rng.integers(0, FACES))
    return Clothes(
        float(height),
        float(rng.uniform(0.9, 1.25)),
        TOPS[int(rng.integers(0, len(TOPS)))],
        _COLOURS[int(rng.integers(0, len(_COLOURS)))],
        "jeans_grey" if rng.random() < 0.6 else "cloth_plain",
        _LEGS[int(rng.integers(0, len(_LEGS)))],
        _SKINS[face % len(_SKINS)],
        f"face_{face}",
        bool(rng.random() < 0.25),
        bool(woman and rng.random() < 0.45),
        bool(rng.random() < 0.4),
        bool(rng.random() < 0.3),
    )


def townsperson_mesh(clothes: Clothes, texture: Mapping[str, int]) -> tuple[Mesh, Gait, tuple[float, float, float]]:
    """A person, how the limbs swing, and length, width, height of the cuboid."""
    top, legs, skin = texture[clothes.top], texture[clothes.legs], texture["skin_tinted"]
    tint, stout = clothes.top_tint, clothes.stout
    bare = clothes.skirt and not clothes.coat
    pieces: list[tuple[Mesh, float, float]] = []
    for side in (-1.0, 1.0):
        foot = (0.01, 0.095 * side, 0.07)
        radii = (0.095 * stout, 0.055)
        cover, colour = (skin, clothes.skin_tint) if bare else (legs, clothes.legs_tint)
        leg = tube((0, 0.095 * side, _HIP_M), foot, radii, cover, 6, tint=colour, caps=False)
        shoe = box((0.27, 0.1, 0.09), (0.06, 0.095 * side, 0.045), texture["rubber"])
        wide = 0.21 + 0.03 * stout
        hand = (0.05, side * (wide + 0.035), 0.84)
        arm = tube((0, side * wide, _SHOULDER_M), hand, (0.062, 0.04), top, 6, tint=tint, repeat=(2.0, 2.0), caps=False)
        fist = tube(hand, (0.06, side * (wide + 0.035), 0.74), (0.035, 0.03), skin, 4, tint=clothes.skin_tint)
        pieces += [(leg, _HIP_M, 0.42 * side), (shoe, _HIP_M, 0.42 * side)]
        pieces += [(arm, _SHOULDER_M, -0.36 * side), (fist, _SHOULDER_M, -0.36 * side)]
    waist, chest = (0.15 * stout, 0.17 * stout) if not clothes.coat else (0.18 * stout, 0.19 * stout)
    trunk = [
        _drum((0.84, 1.22), (waist, waist), top, tint),
        _drum((1.22, 1.44), (waist, chest * 1.08), top, tint),
        _drum((1.44, 1.52), (chest * 1.08, 0.06), top, tint),
    ]
    if clothes.coat:
        trunk.append(_drum((0.5, 0.86), (waist * 1.25, waist), top, tint))
    elif clothes.skirt:
        trunk.append(_drum((0.48, 0.92), (waist * 1.45, waist * 0.98), legs, clothes.legs_tint))
    trunk.append(tube((0, 0, 1.46), (0.01, 0, 1.56), (0.06, 0.055), skin, 5, tint=clothes.skin_tint, caps=False))
    trunk.append(blob((0.02, 0, 1.64), (0.1, 0.085, 0.135), texture[clothes.face], sides=8, repeat=(1.0, 1.0)))
    if clothes.hat:
        trunk.append(tube((0.02, 0, 1.7), (0.01, 0, 1.79), (0.115, 0.09), top, 7, tint=clothes.legs_tint))
    if clothes.bag:
        back = clothes.stout > 1.05
        at, size = ((-0.22, 0, 1.22), (0.16, 0.3, 0.42)) if back else ((0.0, 0.32, 0.86), (0.3, 0.1, 0.28))
        trunk.append(box(size, at, texture["bag"], 0.5))
    pieces += [(mesh, 0.0, 0.0) for mesh in trunk]
    pivot = np.concatenate([np.full(len(mesh.vertices), z) for mesh, z, _ in pieces])
    amplitude = np.concatenate([np.full(len(mesh.vertices), a) for mesh, _, a in pieces])
    scale = clothes.height_m / _ADULT_M
    mesh = merged([piece for piece, _, _ in pieces]).transformed(np.diag([scale, scale, scale, 1.0]))
    gait = Gait(pivot * scale, amplitude, stride_m=1.45 * scale)
    return mesh, gait, (0.6 * scale, 0.6 * scale, clothes.height_m)


def _drum(at_m: tuple[float, float], radii_m: tuple[float, float], texture: int, tint: Tint) -> Mesh:
    """A piece of the body between two heights with its radii there, wider than it is deep."""
    flat = np.diag([0.72, 1.25, 1.0, 1.0])
    return tube(
        (0, 0, at_m[1]), (0, 0, at_m[0]), radii_m[::-1], texture, 8, tint=tint, repeat=(2.0, 0.6), caps=False
    ).transformed(flat)
