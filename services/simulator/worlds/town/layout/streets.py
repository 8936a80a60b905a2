# SPDX-License-Identifier: Apache-2.0
"""Carriageways, kerbs, pavements and verges of the loop and its side streets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.meshes import Mesh, merged
from services.simulator.worlds.town.layout.drape import Drape
from services.simulator.worlds.town.layout.frontage import Frontage
from services.simulator.worlds.town.layout.mouths import KERB_TOP_M, MouthShape
from services.simulator.worlds.town.plan import Line
from services.simulator.worlds.town.profile import (
    KERB_HEIGHT_M,
    KERB_M,
    PAVEMENT_EDGE_M,
    SIDE_KERB_M,
    SIDE_PAVEMENT_EDGE_M,
)
from services.simulator.worlds.town.side_streets import BEYOND_M, SideStreet
from services.simulator.worlds.town.survey import TownSurvey

Floats = NDArray[np.float64]

VERGE_M = 8.0
_VERGE_FALL_M = 0.015
_KERB_FOOT_M = -0.03


def streets_mesh(survey: TownSurvey, drape: Drape, loop_fronts: Sequence[Frontage], texture: Mapping[str, int]) -> Mesh:
    """All paved ground and the lawns beside it; every frontage of the loop has its own paving."""
    shapes = mouth_shapes(survey)
    pieces = [_loop(survey, shapes, drape, loop_fronts, texture)]
    for street in survey.streets:
        pieces.append(_side_street(street, [shape for shape, of, _ in shapes if of is street], drape, texture))
    pieces += [shape.mesh(drape, survey.ground.distances, texture) for shape, _, _ in shapes]
    return merged(pieces)


def mouth_shapes(survey: TownSurvey) -> list[tuple[MouthShape, SideStreet, float]]:
    """Shape, street and side of the loop of every mouth; a street's beginning comes before its end."""
    return [
        (
            MouthShape(
                survey.loop.line, mouth, street.line.part(street.line.length_m, from_end=True) if far else street.line
            ),
            street,
            mouth.side,
        )
        for mouth, street, far in survey.mouths
    ]


def stretches(length_m: float, gaps: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """What gaps (first, last) leave of a closed line; stretches may pass its end."""
    if not gaps:
        return [(0.0, length_m)]
    ordered = sorted((first % length_m, first % length_m + last - first) for first, last in gaps)
    following = [*ordered[1:], (ordered[0][0] + length_m, ordered[0][1] + length_m)]
    return [(last, first) for (_, last), (first, _) in zip(ordered, following, strict=True) if first > last]


def _loop(
    survey: TownSurvey,
    shapes: list[tuple[MouthShape, SideStreet, float]],
    drape: Drape,
    fronts: Sequence[Frontage],
    texture: Mapping[str, int],
) -> Mesh:
    line = survey.loop.line
    s = drape.samples(0.0, line.length_m)
    n = np.linspace(-KERB_M, KERB_M, 9)
    pieces = [drape.sheet(line.point(s[:, None], n[None, :]), 0.0, texture["asphalt"], tile_m=10.24)]
    for side in (-1.0, 1.0):
        gaps = [shape.gap() for shape, _, at in shapes if at == side]
        ends = [(front.last_m, front.character.paving) for front in fronts if front.side == side]
        for first, last in stretches(line.length_m, gaps):
            for begin, end, paving in _by_paving(first, last, line.length_m, ends):
                s = drape.samples(begin, end)
                pieces += _edge(line, s, side, (KERB_M, PAVEMENT_EDGE_M), drape=drape, texture=texture, paving=paving)
    return merged(pieces)


def _by_paving(
    first: float, last: float, length_m: float, ends: list[tuple[float, str]]
) -> list[tuple[float, float, str]]:
    """A stretch of the loop cut where the paving changes; ends: where each paving ends, by s."""
    cuts = sorted((end + lap * length_m, paving) for end, paving in ends for lap in (-1, 0, 1, 2))
    parts = []
    begin = first
    for end, paving in cuts:
        if end > begin:
            parts.append((begin, min(end, last), paving))
            begin = end
        if end >= last:
            break
    return parts


def _side_street(street: SideStreet, shapes: list[MouthShape], drape: Drape, texture: Mapping[str, int]) -> Mesh:
    line, end_m = street.line, street.line.length_m + (0.0 if street.end else BEYOND_M)
    n = np.linspace(-SIDE_KERB_M, SIDE_KERB_M, 5)
    first = shapes[0].kerb_at(n)
    last = end_m - shapes[1].kerb_at(-n) if street.end else np.full_like(n, end_m)
    u = np.linspace(0.0, 1.0, len(drape.samples(0.0, end_m)))[:, None]
    s = first - 0.3 + u * (last - first + 0.6)
    pieces = [drape.sheet(line.point(s, np.broadcast_to(n, s.shape)), -0.002, texture["asphalt"], tile_m=10.24)]
    for hand in (-1.0, 1.0):
        begin = shapes[0].arm_begin(hand)
        stop = end_m - shapes[1].arm_begin(-hand) if street.end else end_m
        edge = (SIDE_KERB_M, SIDE_PAVEMENT_EDGE_M)
        pieces += _edge(line, drape.samples(begin, stop), hand, edge, drape=drape, texture=texture)
    return merged(pieces)


def _edge(
    line: Line,
    s: Floats,
    side: float,
    at_m: tuple[float, float],
    *,
    drape: Drape,
    texture: Mapping[str, int],
    paving: str = "paving",
) -> list[Mesh]:
    """Kerb, pavement and verge on one side of a street; at_m: kerb and back edge."""
    kerb_m, back_m = at_m
    top = KERB_HEIGHT_M
    kerb = [(side * kerb_m, _KERB_FOOT_M), (side * kerb_m, top), (side * (kerb_m + KERB_TOP_M), top)]
    pavement = [(side * n, top) for n in (kerb_m + KERB_TOP_M, 0.5 * (kerb_m + back_m), back_m)]
    verge_n = np.linspace(back_m, back_m + VERGE_M, 4)
    verge = line.point(s[:, None], side * verge_n[None, :])
    fall = top - np.linspace(0.0, _VERGE_FALL_M, 4)
    return [
        drape.strip(line, s, kerb, texture["paving"], tile_m=4.0, tint=(1.12, 1.12, 1.12)),
        drape.strip(line, s, pavement, texture[paving], tile_m=4.0, tint=(0.92, 0.92, 0.92)),
        drape.sheet(verge, fall, texture["grass"], tile_m=5.0),
    ]
