# SPDX-License-Identifier: Apache-2.0
"""Paint on the carriageways, and what road workers left: patches and covers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from services.simulator.shapes.meshes import Mesh, merged
from services.simulator.worlds.town.layout.drape import Drape
from services.simulator.worlds.town.plan import Crossing
from services.simulator.worlds.town.profile import (
    BAY_LENGTH_M,
    CROSSING_CLEAR_M,
    KERB_M,
    LANE_CENTRES_M,
    LANE_WIDTH_M,
    SIDE_KERB_M,
    SIDE_STOP_M,
    ZEBRA_CLEAR_M,
    ZEBRA_HALF_LENGTH_M,
)
from services.simulator.worlds.town.survey import TownSurvey

Floats = NDArray[np.float64]

_JUNCTION_M = 8.0
_STOP_BEFORE_M = 2.6


class Markings:
    """Paints one town."""

    def __init__(self, survey: TownSurvey, drape: Drape, rng: np.random.Generator, texture: Mapping[str, int]) -> None:
        self._survey, self._plan, self._drape = survey, survey.plan, drape
        self._rng, self._texture = rng, texture

    def mesh(self) -> Mesh:
        """All of it."""
        return merged([*self._lanes(), *self._bays(), *self._zebras(), *self._junctions(), *self._wear()])

    def _marks(self, at: Floats, size_m: tuple[float, float], name: str = "worn_paint", layer: int = 2) -> Mesh:
        return self._drape.marks(self._plan.loop, at, size_m, self._texture[name], layer=layer)

    def _free(self, s: Floats, junction_m: float, zebra_m: float) -> Floats:
        """Those of s that keep clear of junctions and zebra crossings."""
        length_m = self._plan.loop.length_m
        keep = np.ones(len(s), bool)
        blocks = [(crossing.s_m, junction_m) for crossing in self._plan.crossings]
        blocks += [(zebra, zebra_m) for zebra in self._plan.zebras_m]
        for at, margin_m in blocks:
            keep &= np.abs((s - at + 0.5 * length_m) % length_m - 0.5 * length_m) >= margin_m
        return s[keep]

    def _lanes(self) -> list[Mesh]:
        """A double line in the middle, dashes between lanes of one direction."""
        length_m = self._plan.loop.length_m
        pieces = []
        step = length_m / round(length_m / 3.0)
        s = self._free(np.arange(0.0, length_m - 0.5, step) + 0.5 * step, _JUNCTION_M + 1.0, 3.4)
        for n in (-0.14, 0.14):
            pieces.append(self._marks(_places(s, n), (step - 0.02, 0.13)))
        step = length_m / round(length_m / 9.0)
        s = self._free(np.arange(0.0, length_m - 1.0, step) + 4.0, _JUNCTION_M + 1.0, 4.5)
        for n in (-LANE_WIDTH_M, LANE_WIDTH_M):
            pieces.append(self._marks(_places(s, n), (3.0, 0.14)))
        return pieces

    def _bays(self) -> list[Mesh]:
        """Marks between parking bays."""
        s = np.arange(0.0, self._plan.loop.length_m - 3.0, BAY_LENGTH_M)
        s = self._free(s, CROSSING_CLEAR_M - 1.0, ZEBRA_CLEAR_M - 1.0)
        edge, middle = 2.0 * LANE_WIDTH_M, 0.5 * (2.0 * LANE_WIDTH_M + KERB_M)
        pieces = []
        for side in (-1.0, 1.0):
            pieces.append(self._marks(_places(s, side * middle), (0.12, KERB_M - edge)))
            pieces.append(self._marks(_places(s, side * edge), (1.3, 0.12), layer=3))
        return pieces

    def _zebras(self) -> list[Mesh]:
        pieces = []
        stripes = np.arange(-KERB_M + 0.6, KERB_M - 0.3, 1.08)
        for s in self._plan.zebras_m:
            at = np.column_stack([np.full(len(stripes), s), stripes])
            pieces.append(self._marks(at, (2.0 * ZEBRA_HALF_LENGTH_M, 0.54)))
            for side in (-1.0, 1.0):
                stop = s + side * (ZEBRA_HALF_LENGTH_M + _STOP_BEFORE_M)
                pieces.append(self._marks(_places(np.array([stop]), side * LANE_WIDTH_M), (0.4, 2.0 * LANE_WIDTH_M)))
        return pieces

    def _junctions(self) -> list[Mesh]:
        """Arrows before junctions; stop lines and dashes of the side streets."""
        pieces = []
        for crossing in self._plan.crossings:
            pieces += self._arrows(crossing)
        for _, street, far in self._survey.mouths:
            line = street.line.part(street.line.length_m, from_end=True) if far else street.line
            paint = self._texture["worn_paint"]
            stop = np.array([[SIDE_STOP_M, 0.5 * SIDE_KERB_M]])
            pieces.append(self._drape.marks(line, stop, (0.45, SIDE_KERB_M - 0.3), paint))
            reach = 0.5 * line.length_m if street.end else line.length_m
            s = np.arange(SIDE_STOP_M + 2.0, reach - 2.0, 6.0)
            pieces.append(self._drape.marks(line, _places(s, 0.0), (2.6, 0.13), paint))
        return pieces

    def _arrows(self, crossing: Crossing) -> list[Mesh]:
        """One in each lane on both approaches, by the arms that lead away."""
        pieces = []
        for direction in (1.0, -1.0):
            # Someone who drives with s has the arm `right` on the right; against s the other way round.
            right, left = (crossing.right, crossing.left) if direction > 0 else (crossing.left, crossing.right)
            s = crossing.s_m - direction * 18.0
            if not len(self._free(np.array([s]), CROSSING_CLEAR_M, ZEBRA_CLEAR_M)):
                continue
            for lane, arm, hand in zip(LANE_CENTRES_M, (left, right), (-1.0, 1.0), strict=True):
                size = (direction * 4.5, direction * hand * 2.2)
                place = _places(np.array([s]), -direction * lane)
                pieces.append(self._marks(place, size, "arrow_1" if arm else "arrow_0"))
        return pieces

    def _wear(self) -> list[Mesh]:
        rng, pieces = self._rng, []
        length_m = self._plan.loop.length_m
        for _ in range(int(length_m / 6.0)):
            size = (float(rng.uniform(0.6, 4.5)), float(rng.uniform(0.5, 2.4)))
            at = np.array([[rng.uniform(0.0, length_m), rng.uniform(-6.0, 6.0)]])
            pieces.append(self._marks(at, size, "patch", layer=1))
        count = int(length_m / 16.0)
        covers = np.column_stack([rng.uniform(0.0, length_m, count), rng.uniform(-5.0, 5.0, count)])
        pieces.append(self._marks(covers, (0.75, 0.75), "manhole", layer=3))
        for street in self._survey.streets:
            count = int(street.line.length_m / 14.0)
            places = np.column_stack(
                [rng.uniform(14.0, street.line.length_m - 14.0, count), rng.uniform(-2.0, 2.0, count)]
            )
            size = (float(rng.uniform(0.8, 3.0)), float(rng.uniform(0.6, 1.6)))
            pieces.append(self._drape.marks(street.line, places, size, self._texture["patch"], layer=1))
        return pieces


def _places(s: Floats, n: float) -> Floats:
    return np.column_stack([s, np.full(len(s), n)])
