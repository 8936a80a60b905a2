# SPDX-License-Identifier: Apache-2.0
"""Trees of several kinds. Object frame: z up, origin on the ground; metres."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from services.simulator.shapes.meshes import Mesh, Tint, blob, merged, tube

Textures = Mapping[str, int]
_ROOT_M = -0.4


def _grey(rng: np.random.Generator) -> Tint:
    tone = float(rng.uniform(0.78, 1.18))
    return (tone, tone, tone)


def _crown(
    rng: np.random.Generator, centre_m: float, spread_m: tuple[float, float], clumps: int, leaves: int
) -> list[Mesh]:
    """Dented clumps round a middle at `centre_m`; spread_m: sideways and upwards."""
    pieces = []
    for k in range(clumps):
        # Evenly over an ellipsoid by the golden angle, a little inside its surface.
        polar, around = np.arccos(1.0 - 2.0 * (k + 0.5) / clumps), 2.399963 * k + float(rng.uniform(-0.3, 0.3))
        out, up = float(rng.uniform(0.5, 0.75)) * np.sin(polar) * spread_m[0], 0.62 * np.cos(polar) * spread_m[1]
        centre = (out * np.cos(around), out * np.sin(around), centre_m + up)
        size = rng.uniform(0.8, 1.2, 3) * [0.52 * spread_m[0], 0.52 * spread_m[0], 0.46 * spread_m[1]]
        pieces.append(blob(centre, size.tolist(), leaves, rng, sides=7, repeat=(3.0, 1.5), tint=_grey(rng)))
    return pieces


def _trunk(top_m: float, radius_m: float, bark: int) -> Mesh:
    return tube((0, 0, _ROOT_M), (0, 0, top_m), (radius_m, 0.55 * radius_m), bark, 7, repeat=(2.0, 4.0), caps=False)


def broad_tree(rng: np.random.Generator, leaves: str, texture: Textures) -> Mesh:
    """Round crown on a strong trunk, 7 to 10 m: lime, maple."""
    height = float(rng.uniform(7.0, 10.0))
    spread = (0.29 * height, 0.3 * height)
    crown = _crown(rng, 0.7 * height, spread, 13, texture[leaves])
    return merged([_trunk(0.62 * height, 0.2, texture["bark"]), *crown])


def birch_tree(rng: np.random.Generator, texture: Textures) -> Mesh:
    """Slender with a white trunk and small light clumps."""
    height = float(rng.uniform(8.0, 11.0))
    crown = _crown(rng, 0.62 * height, (0.16 * height, 0.36 * height), 11, texture["leaves_birch"])
    return merged([_trunk(0.85 * height, 0.13, texture["birch_bark"]), *crown])


def poplar_tree(rng: np.random.Generator, texture: Textures) -> Mesh:
    """A narrow pillar of leaves, 11 to 15 m."""
    height = float(rng.uniform(11.0, 15.0))
    pieces = [_trunk(0.6 * height, 0.2, texture["bark"])]
    for k in range(7):
        z = (0.34 + 0.093 * k) * height
        wide = (1.0 - 0.5 * abs(k - 2.0) / 4.0) * 1.2
        size = [wide, wide, 0.13 * height]
        at = (*rng.uniform(-0.2, 0.2, 2), z)
        pieces.append(blob(at, size, texture["leaves_dark"], rng, sides=8, repeat=(3.0, 2.0), tint=_grey(rng)))
    return merged(pieces)


def fir_tree(rng: np.random.Generator, texture: Textures) -> Mesh:
    """Skirts of needles one above the other, 7 to 11 m."""
    height = float(rng.uniform(7.0, 11.0))
    pieces = [_trunk(0.3 * height, 0.18, texture["bark"])]
    skirts = 6
    for k in range(skirts):
        low = (0.1 + 0.8 * k / skirts) * height
        wide = (1.0 - k / skirts) * 0.24 * height + 0.25
        high = low + 0.26 * height
        needles = texture["needles"]
        pieces.append(
            tube((0, 0, low), (0, 0, high), (wide, 0.04), needles, 9, repeat=(4.0, 2.0), tint=_grey(rng), caps=True)
        )
    return merged(pieces)


def young_tree(rng: np.random.Generator, texture: Textures) -> Mesh:
    """Newly planted, held by two stakes; about 5 m."""
    height = float(rng.uniform(4.5, 5.4))
    stakes = [
        tube((dx, 0, _ROOT_M), (dx, 0, 1.7), (0.05, 0.05), texture["boards"], 5, repeat=(1.0, 3.0))
        for dx in (-0.28, 0.28)
    ]
    crown = _crown(rng, 0.76 * height, (0.9, 0.95), 6, texture["leaves_light"])
    return merged([_trunk(0.7 * height, 0.06, texture["bark"]), *stakes, *crown])


def shrub(rng: np.random.Generator, leaves: str, texture: Textures) -> Mesh:
    """A garden shrub of two or three clumps, about 1.5 m."""
    pieces = []
    for _ in range(int(rng.integers(2, 4))):
        size = rng.uniform([0.5, 0.5, 0.5], [0.9, 0.9, 1.0])
        at = (*rng.uniform(-0.6, 0.6, 2), 0.75 * float(size[2]))
        pieces.append(blob(at, size.tolist(), texture[leaves], rng, sides=7, repeat=(3.0, 1.5), tint=_grey(rng)))
    return merged(pieces)


def tree_kinds(texture: Textures) -> dict[str, Callable[[np.random.Generator], Mesh]]:
    """Every kind by name."""
    return {
        "lime": lambda rng: broad_tree(rng, "leaves_light", texture),
        "maple": lambda rng: broad_tree(rng, "leaves_olive", texture),
        "beech": lambda rng: broad_tree(rng, "leaves_copper", texture),
        "oak": lambda rng: broad_tree(rng, "leaves_dark", texture),
        "birch": lambda rng: birch_tree(rng, texture),
        "poplar": lambda rng: poplar_tree(rng, texture),
        "fir": lambda rng: fir_tree(rng, texture),
        "young": lambda rng: young_tree(rng, texture),
    }
