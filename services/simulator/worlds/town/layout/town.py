# SPDX-License-Identifier: Apache-2.0
"""The whole town as one mesh: ground and paint, then what stands along its streets, then what fills the rest."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.buildings import town_houses
from services.simulator.shapes.buildings.walls import BAY_M, Wall
from services.simulator.shapes.meshes import Mesh, merged
from services.simulator.worlds.town.ground import sampling_m
from services.simulator.worlds.town.layout.character import Character, draw_characters
from services.simulator.worlds.town.layout.drape import Drape
from services.simulator.worlds.town.layout.frontage import Frontage, HouseRow
from services.simulator.worlds.town.layout.furniture import Furniture
from services.simulator.worlds.town.layout.markings import Markings
from services.simulator.worlds.town.layout.site import Site
from services.simulator.worlds.town.layout.streets import streets_mesh
from services.simulator.worlds.town.layout.terrain import terrain_mesh
from services.simulator.worlds.town.layout.unique import landmark_meshes
from services.simulator.worlds.town.plan import Line
from services.simulator.worlds.town.profile import KERB_M, PAVEMENT_EDGE_M, SIDE_KERB_M, SIDE_PAVEMENT_EDGE_M
from services.simulator.worlds.town.side_streets import BEYOND_M
from services.simulator.worlds.town.survey import TownSurvey

Floats = NDArray[np.float64]

_LARGEST_STEP_M = 2.0
_SIDE_BEGIN_M = 20.0
_WOOD_M = (16.0, 60.0)


def town_mesh(survey: TownSurvey, seed: int, max_slope: float, texture: Mapping[str, int]) -> Mesh:
    """Everything that stands; it follows from the survey and the seed."""
    rng = np.random.default_rng([seed, 24])
    drape = Drape(survey.ground.hills, min(_LARGEST_STEP_M, sampling_m(max_slope)))
    loop_fronts, side_fronts = frontages(survey, rng)
    site = Site(survey.ground.distances, survey.ground.hills)
    pieces = [
        streets_mesh(survey, drape, loop_fronts, texture),
        terrain_mesh(survey, drape, texture),
        Markings(survey, drape, rng, texture).mesh(),
    ]
    pieces += landmark_meshes(loop_fronts, site, survey.loop.line.length_m, rng, texture)
    zebras = survey.loop.line.point(np.array(survey.plan.zebras_m), 0.0).reshape(-1, 2)
    furniture = Furniture(site, survey.ground.distances, zebras, rng, texture)
    row = HouseRow(site, rng, texture)
    for frontage in [*loop_fronts, *side_fronts]:
        pieces += row.build(frontage)
    pieces += _street_ends(survey, site, rng, texture)
    for frontage in [*loop_fronts, *side_fronts]:
        pieces += furniture.along(frontage)
    for zebra in survey.plan.zebras_m:
        pieces += [furniture.zebra_lights(frontage, zebra) for frontage in _both_sides(loop_fronts, survey, zebra)]
    pieces += _woods(survey, site, furniture, rng)
    return merged(pieces)


def frontages(survey: TownSurvey, rng: np.random.Generator) -> tuple[list[Frontage], list[Frontage]]:
    """Both sides of every street of the loop, corner to corner, and of every side street."""
    loop = survey.loop
    characters = draw_characters(rng, len(loop.streets) + len(survey.streets))
    on_loop = []
    for k, street in enumerate(loop.streets):
        before = loop.streets[k - 1].corner_m - (loop.line.length_m if k == 0 else 0.0)
        on_loop += _sides(characters[k], loop.line, (before, street.corner_m), (KERB_M, PAVEMENT_EDGE_M))
    on_sides = []
    for k, side_street in enumerate(survey.streets):
        line = side_street.line
        last = line.length_m - _SIDE_BEGIN_M if side_street.end else line.length_m + BEYOND_M - 2.0
        pair = characters[len(loop.streets) + k]
        on_sides += _sides(pair, line, (_SIDE_BEGIN_M, last), (SIDE_KERB_M, SIDE_PAVEMENT_EDGE_M))
    return on_loop, on_sides


def _sides(
    characters: tuple[Character, Character], line: Line, reach_m: tuple[float, float], edge_m: tuple[float, float]
) -> list[Frontage]:
    return [
        Frontage(line, side, *reach_m, *edge_m, character)
        for side, character in zip((1.0, -1.0), characters, strict=True)
    ]


def _both_sides(fronts: list[Frontage], survey: TownSurvey, s: float) -> list[Frontage]:
    """The frontages of the loop left and right of s."""
    length_m = survey.loop.line.length_m
    return [
        front for front in fronts if front.first_m <= s < front.last_m or front.first_m <= s - length_m < front.last_m
    ]


def _street_ends(survey: TownSurvey, site: Site, rng: np.random.Generator, texture: Mapping[str, int]) -> list[Mesh]:
    """A block of flats across the end of every street that leads out of the town."""
    pieces = []
    for street in survey.streets:
        if street.end is not None:
            continue
        end_m = street.line.length_m + BEYOND_M
        heading = float(street.line.heading(end_m)) + 0.5 * np.pi
        pose = site.pose_at(street.line.point(end_m + 6.0, 0.0), heading)
        size, storeys = (BAY_M * int(rng.integers(6, 9)), 11.0), int(rng.integers(3, 6))
        style = str(rng.choice(["grey_panels", "orange_panels", "red_brick", "ochre_plaster"]))
        if site.take(pose, size, centre_y_m=-0.5 * size[1]):
            house = town_houses.flats_mesh(rng, size, storeys, wall=Wall(style), texture=texture)
            pieces.append(house.transformed(pose))
    return pieces


def _woods(survey: TownSurvey, site: Site, furniture: Furniture, rng: np.random.Generator) -> list[Mesh]:
    """Trees on free ground behind the houses."""
    tracks = [(survey.loop.line, survey.loop.line.length_m), *((st.line, st.line.length_m) for st in survey.streets)]
    pieces = []
    kinds = ("lime", "maple", "oak", "birch", "poplar", "fir")
    for line, length_m in tracks:
        for s in np.arange(4.0, length_m, 5.0):
            n = float(rng.choice([-1.0, 1.0]) * rng.uniform(*_WOOD_M))
            pose = site.pose(line, float(s + rng.uniform(-3.0, 3.0)), n)
            kind = str(rng.choice(kinds))
            room_m = 6.0 if kind == "fir" else 4.5
            if site.take(pose, (room_m, room_m)):
                pieces.append(furniture.tree(kind, pose))
    return pieces
