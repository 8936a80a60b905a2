# SPDX-License-Identifier: Apache-2.0
"""What stands on a town's pavements. Object frame: z up, origin on the ground; +y points to the carriageway; metres."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

import numpy as np

from services.simulator.shapes.meshes import Mesh, blob, box, merged, quads, stretch, tube

Textures = Mapping[str, int]
WIRE_HEIGHTS_M = (7.2, 6.8)
_ROOT_M = -0.3


def tall_lamp(texture: Textures) -> Mesh:
    """A lamp of 8 m whose arm reaches 2.2 m over the carriageway."""
    metal = texture["metal"]
    return merged(
        [
            tube((0, 0, _ROOT_M), (0, 0, 8.0), (0.11, 0.06), metal, 7, repeat=(1.0, 8.0)),
            tube((0, 0, _ROOT_M), (0, 0, 1.1), (0.16, 0.14), texture["iron"], 7),
            tube((0, 0, 7.95), (0, 2.2, 8.35), (0.05, 0.04), metal, 5),
            box((0.34, 0.9, 0.14), (0, 2.3, 8.33), texture["paving"], 2.0),
        ]
    )


def lantern(texture: Textures) -> Mesh:
    """An old lantern on an iron post, 4 m."""
    iron = texture["iron"]
    return merged(
        [
            tube((0, 0, _ROOT_M), (0, 0, 3.3), (0.08, 0.05), iron, 7),
            tube((0, 0, _ROOT_M), (0, 0, 0.8), (0.15, 0.11), iron, 7),
            tube((0, 0, 3.3), (0, 0, 3.85), (0.14, 0.24), texture["worn_paint"], 6),
            tube((0, 0, 3.85), (0, 0, 4.1), (0.3, 0.03), iron, 6),
        ]
    )


def wire_pole(texture: Textures) -> Mesh:
    """A wooden pole with a crossbar for wires, which run along x."""
    insulators = [tube((0, dy, 7.12), (0, dy, 7.3), (0.05, 0.04), texture["worn_paint"], 5) for dy in (-0.7, 0.0, 0.7)]
    return merged(
        [
            tube((0, 0, _ROOT_M), (0, 0, 7.4), (0.15, 0.1), texture["boards"], 7, repeat=(2.0, 5.0)),
            box((0.12, 1.7, 0.12), (0, 0, 7.05), texture["boards"], 2.0),
            *insulators,
        ]
    )


def wires(start: np.ndarray, end: np.ndarray, texture: Textures) -> Mesh:
    """Three wires that hang between the crossbars of two poles; 4x4 poses in the world frame."""
    pieces = []
    for dy in (-0.7, 0.0, 0.7):
        a, b = (pose[:3, :3] @ [0.0, dy, 7.28] + pose[:3, 3] for pose in (start, end))
        u = np.linspace(0.0, 1.0, 6)
        line = a + u[:, None] * (b - a)
        line[:, 2] -= 0.7 * 4.0 * u * (1.0 - u)
        for p, q in pairwise(line):
            pieces.append(tube(p, q, (0.02, 0.02), texture["rubber"], 3, caps=False))
    return merged(pieces)


def board_on_post(board: str, texture: Textures, *, size_m: float = 0.72, low_m: float = 2.0) -> Mesh:
    """A square sign on a post that faces -x."""
    half, z = 0.5 * size_m, low_m + 0.5 * size_m
    face = [[-0.05, half, z + half], [-0.05, -half, z + half], [-0.05, -half, z - half], [-0.05, half, z - half]]
    back = [[-0.02, y, height] for _, y, height in face]
    unit = stretch()
    return merged(
        [
            tube((0, 0, _ROOT_M), (0, 0, z + half + 0.1), (0.035, 0.035), texture["metal"], 6, repeat=(1.0, 4.0)),
            quads([face], unit, texture[board]),
            quads([back], unit, texture["metal"]),
        ]
    )


def traffic_light(texture: Textures) -> Mesh:
    """Signals on a post and on an arm above the lane; they face -x."""
    iron, unit = texture["iron"], stretch()
    pieces = [
        tube((0, 0, _ROOT_M), (0, 0, 5.6), (0.1, 0.07), iron, 7),
        tube((0, 0, 5.5), (0, 3.4, 5.6), (0.06, 0.04), iron, 5),
    ]
    for y, z in ((0.0, 2.9), (3.2, 5.3)):
        pieces.append(box((0.25, 0.36, 0.95), (-0.12, y, z), iron, 1.0))
        face = [[-0.26, y + dy, z + dz] for dy, dz in ((0.17, 0.45), (-0.17, 0.45), (-0.17, -0.45), (0.17, -0.45))]
        pieces.append(quads([face], unit, texture["traffic_light"]))
    return merged(pieces)


def advertising_column(posters: tuple[str, str, str], texture: Textures) -> Mesh:
    """A round column of posters, 3 m."""
    pieces = [tube((0, 0, _ROOT_M), (0, 0, 0.35), (0.7, 0.7), texture["plain_sandstone"], 12, repeat=(3.0, 0.3))]
    angle = np.linspace(0.0, 2.0 * np.pi, 13)
    for k, poster in enumerate(posters):
        part = angle[4 * k : 4 * k + 5]
        ring = 0.62 * np.stack([np.cos(part), np.sin(part)], axis=1)
        corners = [[[*ring[i], 2.7], [*ring[i + 1], 2.7], [*ring[i + 1], 0.35], [*ring[i], 0.35]] for i in range(4)]
        uv = [[[i / 4, 0], [(i + 1) / 4, 0], [(i + 1) / 4, 1], [i / 4, 1]] for i in range(4)]
        pieces.append(quads(corners, uv, texture[poster], one_part=True))
    pieces.append(tube((0, 0, 2.7), (0, 0, 2.95), (0.75, 0.7), texture["paint_green"], 12))
    pieces.append(tube((0, 0, 2.95), (0, 0, 3.5), (0.6, 0.05), texture["paint_green"], 12))
    return merged(pieces)


def bus_stop(poster: str, texture: Textures) -> Mesh:
    """A shelter with a bench, a poster at its end, and the stop's sign."""
    iron, glass = texture["iron"], texture["railing_white"]
    unit = stretch()
    pieces = [
        box((4.2, 1.6, 0.12), (0, -0.3, 2.45), iron, 2.0),
        box((3.2, 0.45, 0.08), (0, -0.75, 0.48), texture["boards"], 2.0),
    ]
    pieces += [box((0.08, 0.08, 2.6), (x, y, 1.15), iron, 1.0) for x in (-2.0, 2.0) for y in (-1.05, 0.4)]
    pieces.append(
        quads(
            [[[-2, -1.05, 2.2], [2, -1.05, 2.2], [2, -1.05, 0.4], [-2, -1.05, 0.4]]], np.array(unit) * [2.0, 1.0], glass
        )
    )
    for x, left, right in ((1.97, 0.35, -1.0), (2.05, -1.0, 0.35)):
        face = [[x, left, 2.1], [x, right, 2.1], [x, right, 0.4], [x, left, 0.4]]
        pieces.append(quads([face], unit, texture[poster]))
    sign = board_on_post("timetable", texture, size_m=0.6, low_m=1.9).transformed(_at(-3.0, 0.3))
    return merged([*pieces, sign])


def billboard(poster: str, texture: Textures) -> Mesh:
    """A wide poster on two legs that faces +y."""
    unit = stretch()
    face = [[1.9, 0.06, 3.6], [-1.9, 0.06, 3.6], [-1.9, 0.06, 1.0], [1.9, 0.06, 1.0]]
    legs = [box((0.14, 0.14, 1.6), (x, -0.05, 0.5), texture["iron"], 1.0) for x in (-1.4, 1.4)]
    return merged(
        [quads([face], unit, texture[poster]), box((4.0, 0.1, 2.8), (0, 0, 2.3), texture["iron"], 1.0), *legs]
    )


def bench(texture: Textures) -> Mesh:
    """A wooden bench that looks at the carriageway."""
    return merged(
        [
            box((1.8, 0.45, 0.07), (0, 0, 0.46), texture["boards"], 2.0),
            box((1.8, 0.06, 0.45), (0, -0.24, 0.78), texture["boards"], 2.0),
            *[box((0.08, 0.4, 0.6), (x, 0, 0.16), texture["iron"], 1.0) for x in (-0.75, 0.75)],
        ]
    )


def litter_bin(texture: Textures) -> Mesh:
    """A round litter bin."""
    return tube((0, 0, _ROOT_M), (0, 0, 0.95), (0.26, 0.3), texture["paint_green"], 9, repeat=(2.0, 1.0))


def hydrant(texture: Textures) -> Mesh:
    """A red hydrant."""
    return merged(
        [
            tube((0, 0, _ROOT_M), (0, 0, 0.7), (0.13, 0.12), texture["paint_red"], 8),
            blob((0, 0, 0.72), (0.14, 0.14, 0.12), texture["paint_red"], sides=7),
            box((0.4, 0.12, 0.12), (0, 0, 0.5), texture["paint_yellow"], 1.0),
        ]
    )


def cabinet(texture: Textures) -> Mesh:
    """A grey cabinet of the telephone company."""
    return box((1.1, 0.4, 1.5), (0, 0, 0.6), texture["cladding_grey"], 1.2, (0.8, 0.84, 0.8))


def letter_box(texture: Textures) -> Mesh:
    """A yellow letter box on a post."""
    post = tube((0, 0, _ROOT_M), (0, 0, 0.8), (0.05, 0.05), texture["metal"], 6)
    return merged([post, box((0.5, 0.4, 0.6), (0, 0, 1.05), texture["paint_yellow"], 1.0)])


def garden_fence(kind: str, length_m: float, texture: Textures) -> Mesh:
    """Along x: hedge, wall, boards, pickets or rails."""
    half = 0.5 * length_m
    if kind == "hedge":
        return box((length_m, 0.7, 1.7), (0.0, 0.0, 0.5), texture["hedge"], 2.0)
    if kind == "wall":
        wall = box((length_m, 0.25, 1.3), (0.0, 0.0, 0.35), texture["wall"], 3.0)
        return merged([wall, box((length_m + 0.1, 0.35, 0.08), (0.0, 0.0, 1.03), texture["paving"], 4.0)])
    if kind == "boards":
        posts = [box((0.12, 0.14, 1.8), (x, 0, 0.4), texture["boards"], 2.0) for x in np.arange(-half, half + 0.1, 2.0)]
        return merged([box((length_m, 0.05, 1.4), (0, 0, 0.5), texture["boards"], 2.0), *posts])
    if kind == "pickets":
        x = np.arange(-half, half, 0.24)
        faces = [[[v, 0, 1.0], [v + 0.12, 0, 1.0], [v + 0.12, 0, -0.1], [v, 0, -0.1]] for v in x.tolist()]
        unit = stretch(0.2, 1)
        rails = [box((length_m, 0.06, 0.08), (0, -0.04, z), texture["worn_paint"], 2.0) for z in (0.25, 0.75)]
        return merged([quads(faces, unit, texture["worn_paint"], one_part=True), *rails])
    posts = [box((0.08, 0.08, 1.6), (x, 0, 0.3), texture["iron"], 1.0) for x in np.arange(-half, half + 0.1, 1.5)]
    rails = [box((length_m, 0.05, 0.06), (0, 0, z), texture["iron"], 1.0) for z in (0.35, 0.7, 1.02)]
    return merged([*posts, *rails])


def _at(x: float, y: float) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:2, 3] = x, y
    return matrix
