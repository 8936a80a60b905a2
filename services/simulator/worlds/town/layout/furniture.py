# SPDX-License-Identifier: Apache-2.0
"""Trees, lamps, poles, signs and other things along the kerbs of one frontage after another."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from services.simulator.painting.buildings.shopfronts import POSTERS
from services.simulator.painting.library import SIGN_COUNT
from services.simulator.painting.town_library import TOWN_SIGNS
from services.simulator.shapes.meshes import Mesh
from services.simulator.shapes.things import street_things, trees
from services.simulator.shapes.things.greenery import bin_mesh
from services.simulator.worlds.town.carriageways import DistanceMap
from services.simulator.worlds.town.layout.frontage import Frontage
from services.simulator.worlds.town.layout.site import Site
from services.simulator.worlds.town.profile import KERB_HEIGHT_M, KERB_M, ZEBRA_HALF_LENGTH_M

Floats = NDArray[np.float64]

_VARIANTS = 3
_KERB_SIDE_M = 0.6
"""Trees and lamps stand this far behind the kerb; what stands at the back is behind the pavement, clear of people."""
_BACK_SIDE_M = 0.4


class Furniture:
    """Sets things down; keeps clear of mouths and zebra crossings."""

    def __init__(
        self,
        site: Site,
        distances: DistanceMap,
        zebras: Floats,
        rng: np.random.Generator,
        texture: Mapping[str, int],
    ) -> None:
        self._site, self._distances, self._zebras = site, distances, zebras
        self._rng, self._texture = rng, texture
        grown = trees.tree_kinds(texture)
        self._trees = {name: [grow(rng) for _ in range(_VARIANTS)] for name, grow in grown.items()}
        self._posters = rng.permutation(POSTERS).tolist()
        self._made: dict[str, Mesh] = {}
        self._lamps = {"tall_lamp": street_things.tall_lamp(texture), "lantern": street_things.lantern(texture)}

    def along(self, frontage: Frontage) -> list[Mesh]:
        """Everything along the kerb of one frontage."""
        wide = frontage.kerb_m >= KERB_M
        pieces = self._poles(frontage) if frontage.character.poles else self._lamps_of(frontage)
        pieces += self._signs(frontage)
        if wide:
            pieces += self._trees_of(frontage)
            pieces += self._bus_stop(frontage)
        return pieces + self._small_things(frontage)

    def tree(self, kind: str, pose: Floats) -> Mesh:
        """A tree of a kind, turned and scaled at random."""
        rng = self._rng
        yaw, scale = float(rng.uniform(0.0, 2.0 * np.pi)), float(rng.uniform(0.85, 1.2))
        turn = np.eye(4)
        turn[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
        turn[:3, :3] *= scale
        tone = rng.uniform(0.88, 1.12, 3)
        variant = self._trees[kind][int(rng.integers(0, _VARIANTS))]
        return variant.transformed(pose @ turn).tinted((float(tone[0]), float(tone[1]), float(tone[2])))

    def _once(self, name: str, make: Callable[[], Mesh]) -> Mesh:
        """A thing of which all specimens are equal."""
        if name not in self._made:
            self._made[name] = make()
        return self._made[name]

    def _pose(self, frontage: Frontage, s: float, behind_kerb_m: float, yaw: float = 0.0) -> Floats:
        n = frontage.side * (frontage.kerb_m + behind_kerb_m)
        return self._site.pose(frontage.line, s, n, frontage.turn + yaw)

    def _clear(self, pose: Floats, margin_m: float = 0.35) -> bool:
        """On a pavement, not in a mouth, and not where people wait at a zebra crossing."""
        place = pose[:2, 3]
        if float(self._distances.outside_m(place)) < margin_m:
            return False
        return not len(self._zebras) or float(np.linalg.norm(self._zebras - place, axis=1).min()) > KERB_M + 3.2

    def _every(self, frontage: Frontage, step_m: float, jitter_m: float = 0.0) -> list[float]:
        s = np.arange(frontage.first_m + float(self._rng.uniform(1.0, step_m)), frontage.last_m - 1.0, step_m)
        return [float(at) for at in s + self._rng.uniform(-jitter_m, jitter_m, len(s))]

    def _lamps_of(self, frontage: Frontage) -> list[Mesh]:
        character = frontage.character
        poses = [self._pose(frontage, s, 0.5) for s in self._every(frontage, character.lamp_m)]
        return [self._lamps[character.lamp].transformed(pose) for pose in poses if self._clear(pose)]

    def _poles(self, frontage: Frontage) -> list[Mesh]:
        """Poles and, where two neighbours stand, the wires between them."""
        pole = street_things.wire_pole(self._texture)
        poses = [self._pose(frontage, s, 0.5) for s in self._every(frontage, 27.0)]
        poses = [pose for pose in poses if self._clear(pose)]
        pieces = [pole.transformed(pose) for pose in poses]
        for a, b in pairwise(poses):
            if float(np.linalg.norm(a[:2, 3] - b[:2, 3])) < 40.0:
                pieces.append(street_things.wires(a, b, self._texture))
        return pieces

    def _trees_of(self, frontage: Frontage) -> list[Mesh]:
        character = frontage.character
        pieces = []
        for s in self._every(frontage, character.tree_m, 1.2):
            pose = self._pose(frontage, s, _KERB_SIDE_M)
            kind = character.trees[int(self._rng.random() < 0.25)]
            if self._clear(pose, 0.6):
                pieces.append(self.tree(kind, pose))
        return pieces

    def _signs(self, frontage: Frontage) -> list[Mesh]:
        """They face those who drive on this side."""
        pieces = []
        for s in self._every(frontage, 34.0, 9.0):
            number = int(self._rng.integers(0, SIGN_COUNT + TOWN_SIGNS))
            name = f"sign_{number}" if number < SIGN_COUNT else f"town_sign_{number - SIGN_COUNT}"
            pose = self._pose(frontage, s, 0.5)
            if self._clear(pose, 0.45):
                board = self._once(name, partial(street_things.board_on_post, name, self._texture))
                pieces.append(board.transformed(pose))
        return pieces

    def _bus_stop(self, frontage: Frontage) -> list[Mesh]:
        """At most one a frontage, behind the pavement."""
        rng = self._rng
        if rng.random() < 0.45 or frontage.last_m - frontage.first_m < 40.0:
            return []
        s = float(rng.uniform(frontage.first_m + 15.0, frontage.last_m - 15.0))
        pose = self._pose(frontage, s, frontage.back_m - frontage.kerb_m + 0.35)
        beside = self._pose(frontage, s, frontage.back_m - frontage.kerb_m + 1.3)
        if not self._clear(pose, 3.5) or not self._site.take(beside, (5.0, 1.4)):
            return []
        return [street_things.bus_stop(self._poster(), self._texture).transformed(pose)]

    def _poster(self) -> str:
        if not self._posters:
            self._posters = self._rng.permutation(POSTERS).tolist()
        return f"poster_{self._posters.pop()}"

    def _small_things(self, frontage: Frontage) -> list[Mesh]:
        """Bins, benches, hydrants, cabinets, letter boxes; columns and hoardings of posters."""
        rng, texture, pieces = self._rng, self._texture, []
        back = frontage.back_m - frontage.kerb_m
        for s in self._every(frontage, 11.0, 4.0):
            choice, reach_m = rng.random(), 0.6
            at_back = self._pose(frontage, s, back + _BACK_SIDE_M, float(rng.uniform(-0.08, 0.08)))
            at_kerb = self._pose(frontage, s, _KERB_SIDE_M + 0.05)
            if choice < 0.3:
                thing, pose = self._once("bin", partial(bin_mesh, texture)), self._pose(frontage, s, back + 0.45)
            elif choice < 0.42:
                thing, pose, reach_m = self._once("bench", partial(street_things.bench, texture)), at_back, 1.2
            elif choice < 0.54:
                thing, pose = self._once("litter_bin", partial(street_things.litter_bin, texture)), at_kerb
            elif choice < 0.62:
                thing, pose = self._once("hydrant", partial(street_things.hydrant, texture)), at_kerb
            elif choice < 0.72:
                thing, pose = self._once("cabinet", partial(street_things.cabinet, texture)), at_back
            elif choice < 0.78:
                thing, pose = self._once("letter_box", partial(street_things.letter_box, texture)), at_back
            elif choice < 0.84:
                posters = (self._poster(), self._poster(), self._poster())
                thing = street_things.advertising_column(posters, texture)
                pose = self._pose(frontage, s, back + 1.0, float(rng.uniform(0.0, 6.0)))
            elif choice < 0.9:
                thing, pose = street_things.billboard(self._poster(), texture), self._pose(frontage, s, back + 1.0)
                reach_m = 2.5
            else:
                continue
            room = (2.0 * reach_m, 0.9)
            if self._clear(pose, reach_m) and (
                self._behind(pose) < 0.0 or self._site.take(pose, room, centre_y_m=-0.25)
            ):
                pieces.append(thing.transformed(pose))
        return pieces

    def _behind(self, pose: Floats) -> float:
        return float(self._distances.behind_pavement_m(pose[:2, 3]))

    def zebra_lights(self, frontage: Frontage, zebra_m: float) -> Mesh:
        """The signal that stops this side's traffic at a zebra crossing of the loop."""
        before = zebra_m + frontage.side * (ZEBRA_HALF_LENGTH_M + 1.2)
        pose = self._site.pose(
            frontage.line, before, frontage.side * (KERB_M + _KERB_SIDE_M), frontage.turn, KERB_HEIGHT_M
        )
        return street_things.traffic_light(self._texture).transformed(pose)
