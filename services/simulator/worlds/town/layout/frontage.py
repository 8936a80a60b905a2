# SPDX-License-Identifier: Apache-2.0
"""One side of one street, and the row of houses along it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from services.simulator.painting.buildings.shopfronts import MURALS, SHOPS
from services.simulator.shapes.buildings import town_houses
from services.simulator.shapes.buildings.walls import BAY_M, Wall
from services.simulator.shapes.meshes import Mesh, Tint, quads
from services.simulator.shapes.things import street_things, trees
from services.simulator.worlds.town.layout.character import MIXES, Character
from services.simulator.worlds.town.layout.site import Site
from services.simulator.worlds.town.plan import Line

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Frontage:
    """Side (+1 left, -1 right) of a line from first_m to last_m; kerb_m, back_m: kerb and back edge of the pavement."""

    line: Line
    side: float
    first_m: float
    last_m: float
    kerb_m: float
    back_m: float
    character: Character

    @property
    def turn(self) -> float:
        """Yaw, against the line, of what looks at the street along its own +y."""
        return np.pi if self.side > 0 else 0.0


@dataclass(frozen=True, slots=True)
class _Lot:
    """A house to be: kind, width, depth, storeys."""

    kind: str
    width_m: float
    depth_m: float
    storeys: int


class HouseRow:
    """Builds the houses of one frontage after another; shops and murals are used once where possible."""

    def __init__(self, site: Site, rng: np.random.Generator, texture: Mapping[str, int]) -> None:
        self._site, self._rng, self._texture = site, rng, texture
        self._shops = rng.permutation(SHOPS).tolist()
        self._murals = rng.permutation(MURALS).tolist()
        kinds = ("leaves_olive", "leaves_dark", "leaves_light")
        self._shrubs = [trees.shrub(rng, leaves, texture) for leaves in kinds for _ in range(3)]

    def build(self, frontage: Frontage) -> list[Mesh]:
        """Houses from one end to the other, with what belongs into their gardens."""
        rng, character = self._rng, frontage.character
        mix = MIXES[character.mix]
        setback = float(rng.uniform(*mix.setback_m))
        pieces: list[Mesh] = []
        s = frontage.first_m + float(rng.uniform(0.0, 3.0))
        while s < frontage.last_m:
            lot = self._lot(mix.houses)
            own = setback if mix.gap_m[1] == 0.0 else setback + float(rng.uniform(-0.3, 1.2))
            n = frontage.side * (frontage.back_m + own)
            step = lot.width_m / self._stretch(frontage, s, n)
            pose = self._site.pose(frontage.line, s + 0.5 * step, n, frontage.turn)
            if s + step > frontage.last_m + 2.0 or not self._fits(pose, lot):
                s += 1.5
                continue
            pieces += self._house(pose, lot, frontage, own)
            s += step + float(rng.uniform(*mix.gap_m)) / self._stretch(frontage, s, n)
        return pieces

    def _stretch(self, frontage: Frontage, s: float, n: float) -> float:
        """Metres along the fronts for a metre along the line."""
        a, b = frontage.line.point(np.array([s, s + 2.0]), n)
        return max(0.4, float(np.linalg.norm(b - a)) / 2.0)

    def _lot(self, kinds: tuple[tuple[str, float], ...]) -> _Lot:
        rng = self._rng
        weights = np.array([weight for _, weight in kinds])
        kind = kinds[int(rng.choice(len(kinds), p=weights / weights.sum()))][0]
        bays, depth, storeys = {
            "terrace": ((2, 4), (8.0, 10.0), (2, 4)),
            "villa": ((3, 5), (8.0, 11.0), (1, 3)),
            "flats": ((6, 10), (10.0, 12.5), (4, 7)),
            "shop": ((3, 5), (9.0, 11.0), (2, 5)),
            "hall": ((6, 9), (14.0, 20.0), (1, 2)),
        }[kind]
        return _Lot(kind, BAY_M * int(rng.integers(*bays)), float(rng.uniform(*depth)), int(rng.integers(*storeys)))

    def _fits(self, pose: Floats, lot: _Lot) -> bool:
        """Whether the ground is free; the forecourt of a step and a bay counts, neighbours may touch."""
        return self._site.take(pose, (lot.width_m, lot.depth_m), slack_m=0.9, centre_y_m=-0.5 * lot.depth_m)

    def _house(self, pose: Floats, lot: _Lot, frontage: Frontage, setback_m: float) -> list[Mesh]:
        rng, texture, character = self._rng, self._texture, frontage.character
        tone = rng.uniform(0.9, 1.06, 3) * rng.uniform(0.82, 1.0)
        tint: Tint = (float(tone[0]), float(tone[1]), float(tone[2]))
        joined = MIXES[character.mix].gap_m[1] == 0.0
        style = character.panels if lot.kind == "flats" and rng.random() < 0.6 else character.style(rng, lot.storeys)
        shop = None
        if lot.kind == "shop":
            shop = int(self._shops.pop() if self._shops else rng.integers(0, SHOPS))
        wall = Wall(style, tint, int(rng.integers(0, 4)), joined and lot.kind in ("terrace", "shop"), shop)
        roof = character.roofs[int(rng.random() < 0.3)]
        size = (lot.width_m, lot.depth_m)
        if lot.kind == "hall":
            house = town_houses.hall_mesh(rng, size, texture)
        elif lot.kind == "flats":
            house = town_houses.flats_mesh(rng, size, lot.storeys, wall=wall, texture=texture)
        else:
            build = {
                "terrace": town_houses.terrace_mesh,
                "villa": town_houses.villa_mesh,
                "shop": town_houses.shop_mesh,
            }[lot.kind]
            house = build(rng, size, lot.storeys, wall=wall, roof=roof, texture=texture)
        pieces = [house]
        if wall.blank_sides and self._murals and rng.random() < 0.3:
            pieces.append(self._mural(lot))
        garden = [] if lot.kind in ("shop", "hall") else self._garden(pose, lot, setback_m, character)
        return [piece.transformed(pose) for piece in [*pieces, *garden]]

    def _mural(self, lot: _Lot) -> Mesh:
        """A painting on one side wall."""
        number, x = int(self._murals.pop()), float(self._rng.choice([-1.0, 1.0])) * (0.5 * lot.width_m + 0.03)
        high, wide = min(6.0, 3.0 * lot.storeys - 0.4), lot.depth_m - 1.2
        face = [[x, -0.6, high], [x, -0.6 - wide, high], [x, -0.6 - wide, 0.4], [x, -0.6, 0.4]]
        return quads([face], [[0, 0], [1, 0], [1, 1], [0, 1]], self._texture[f"mural_{number}"])

    def _garden(self, pose: Floats, lot: _Lot, setback_m: float, character: Character) -> list[Mesh]:
        """Between the front and the pavement: shrubs, a fence with a way through, a path."""
        rng, texture = self._rng, self._texture
        pieces: list[Mesh] = []
        if setback_m > 1.6:
            for _ in range(int(rng.integers(1, 4))):
                at = np.eye(4)
                at[:2, 3] = rng.uniform(-0.45, 0.45) * lot.width_m, rng.uniform(0.7, max(0.8, setback_m - 1.6))
                at[:2, :2] *= rng.choice([-1.0, 1.0], 2) * rng.uniform(0.85, 1.1)
                if not self._site.is_free(pose @ at, (2.0, 1.3)):
                    continue
                pieces.append(self._shrubs[int(rng.integers(0, len(self._shrubs)))].transformed(at))
        if setback_m > 2.2 and lot.kind != "flats":
            length = 0.5 * lot.width_m - 0.7
            for x in (-0.25 * lot.width_m - 0.35, 0.25 * lot.width_m + 0.35):
                at = np.eye(4)
                at[:2, 3] = x, setback_m - 1.05
                if self._site.is_free(pose @ at, (length + 0.2, 0.9)):
                    pieces.append(street_things.garden_fence(character.fence, length, texture).transformed(at))
        return pieces
