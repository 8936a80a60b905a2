# SPDX-License-Identifier: Apache-2.0
"""What stands in a town once, so that its streets are told apart from far: a church and some other landmarks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from services.simulator.shapes.buildings import landmarks, town_houses
from services.simulator.shapes.meshes import Mesh
from services.simulator.worlds.town.layout.frontage import Frontage
from services.simulator.worlds.town.layout.site import Site

_EVERY_M = 220.0
"""Length of the loop for each landmark beside the church."""
_SHARES = (0.5, 0.35, 0.65, 0.2, 0.8)


def landmark_meshes(
    fronts: Sequence[Frontage], site: Site, length_m: float, rng: np.random.Generator, texture: Mapping[str, int]
) -> list[Mesh]:
    """A church and, by the loop's `length_m`, other landmarks, each on a frontage of its own."""
    order = [fronts[int(number)] for number in rng.permutation(len(fronts))]
    pieces = _church(order, site, rng, texture)
    kinds = rng.permutation(list(landmarks.KINDS)).tolist()
    for number in range(round(length_m / _EVERY_M)):
        build, size, centre_y = landmarks.KINDS[kinds[number % len(kinds)]]
        front = order[(number + 1) % len(order)]
        for share in _SHARES:
            s = front.first_m + share * (front.last_m - front.first_m)
            away = front.back_m + 1.0 + centre_y + 0.5 * size[1]
            pose = site.pose(front.line, s, front.side * away, front.turn)
            if site.take(pose, size, centre_y_m=centre_y):
                pieces.append(build(texture).transformed(pose))
                break
    return pieces


def _church(order: list[Frontage], site: Site, rng: np.random.Generator, texture: Mapping[str, int]) -> list[Mesh]:
    """Wherever along the loop it finds room; its spire is seen from far."""
    style = str(rng.choice(["sandstone", "yellow_brick"]))
    roof = str(rng.choice(["roof_slate", "roof_red", "roof_moss"]))
    for front in order:
        for share in _SHARES[:3]:
            s = front.first_m + share * (front.last_m - front.first_m)
            pose = site.pose(front.line, s, front.side * (front.back_m + 8.5), front.turn)
            if site.take(pose, (13.0, 30.0), centre_y_m=-9.0):
                return [town_houses.church_mesh(texture, style, roof).transformed(pose)]
    return []
