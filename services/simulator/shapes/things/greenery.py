# SPDX-License-Identifier: Apache-2.0
"""Trees, lamps, signs and bins along the pavement. Object frame: z up, origin on the ground; metres."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from services.simulator.shapes.meshes import Mesh, blob, box, merged, quads, tube


def tree_mesh(rng: np.random.Generator, texture: Mapping[str, int]) -> Mesh:
    """A tree of 6 to 9 m with a crown of several dented clumps."""
    height = rng.uniform(5.5, 8.5)
    leaves = texture[("leaves_light", "leaves_dark", "leaves_olive")[int(rng.integers(0, 3))]]
    lean = rng.uniform(-0.25, 0.25, 2)
    top = (lean[0], lean[1], 0.62 * height)
    pieces = [tube((0, 0, 0), top, (0.2, 0.11), texture["bark"], 8, repeat=(2.0, 4.0), caps=False)]
    for _ in range(int(rng.integers(4, 7))):
        centre = np.array([*lean, 0.68 * height]) + rng.normal(0.0, [0.75, 0.75, 0.55])
        radii = rng.uniform([1.0, 1.0, 0.8], [1.7, 1.7, 1.3])
        tone = float(rng.uniform(0.8, 1.15))
        tint = (tone, tone, tone)
        pieces.append(blob(centre.tolist(), radii.tolist(), leaves, rng, sides=10, repeat=(4.0, 2.0), tint=tint))
    return merged(pieces)


def bush_mesh(rng: np.random.Generator, texture: Mapping[str, int]) -> Mesh:
    """A bush of about a metre."""
    radii = rng.uniform([0.5, 0.5, 0.5], [1.0, 0.9, 0.9])
    return blob((0.0, 0.0, 0.7 * radii[2]), radii.tolist(), texture["leaves_olive"], rng)


def lamp_mesh(texture: Mapping[str, int]) -> Mesh:
    """A street lamp whose arm reaches 1.4 m along +y."""
    metal = texture["metal"]
    return merged(
        [
            tube((0, 0, 0), (0, 0, 5.6), (0.09, 0.06), metal, 8, repeat=(1.0, 8.0)),
            tube((0, 0, 0), (0, 0, 0.9), (0.14, 0.12), metal, 8, repeat=(1.0, 2.0)),
            tube((0, 0, 5.55), (0, 1.4, 5.75), (0.04, 0.04), metal, 6),
            box((0.3, 0.7, 0.14), (0, 1.5, 5.74), texture["paving"], 2.0),
        ]
    )


def sign_mesh(kind: int, texture: Mapping[str, int]) -> Mesh:
    """A traffic sign that faces -x, number `kind`."""
    z, half = 2.3, 0.36
    face = [[-0.05, half, z + half], [-0.05, -half, z + half], [-0.05, -half, z - half], [-0.05, half, z - half]]
    back = [[-0.03, y, height] for _, y, height in face]
    return merged(
        [
            tube((0, 0, 0), (0, 0, 2.75), (0.035, 0.035), texture["metal"], 6, repeat=(1.0, 4.0)),
            quads([face], [[0, 0], [1, 0], [1, 1], [0, 1]], texture[f"sign_{kind}"]),
            quads([back], [[0, 0], [1, 0], [1, 1], [0, 1]], texture["metal"]),
        ]
    )


def bin_mesh(texture: Mapping[str, int]) -> Mesh:
    """A wheeled bin at the kerb."""
    return merged(
        [
            box((0.6, 0.6, 0.95), (0, 0, 0.5), texture["bin"], 1.0),
            box((0.68, 0.66, 0.08), (0, 0, 1.02), texture["rubber"], 1.0),
        ]
    )
