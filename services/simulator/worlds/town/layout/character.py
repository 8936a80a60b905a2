# SPDX-License-Identifier: Apache-2.0
"""What makes one street unlike another: its own mix of houses, colours, trees, lamps and pavings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from services.simulator.painting.buildings.storeys import STYLES
from services.simulator.painting.town_library import PAVINGS, TOWN_ROOFS


@dataclass(frozen=True, slots=True)
class HouseMix:
    """houses: kind and weight. setback_m: from the pavement to the fronts. gap_m: between neighbours."""

    houses: tuple[tuple[str, float], ...]
    setback_m: tuple[float, float]
    gap_m: tuple[float, float]


MIXES = {
    "terraces": HouseMix((("terrace", 1.0),), (0.4, 2.4), (0.0, 0.0)),
    "centre": HouseMix((("shop", 0.6), ("flats", 0.2), ("terrace", 0.2)), (0.1, 0.3), (0.0, 0.0)),
    "villas": HouseMix((("villa", 0.9), ("terrace", 0.1)), (3.5, 6.0), (3.0, 8.0)),
    "blocks": HouseMix((("flats", 0.85), ("shop", 0.15)), (2.0, 4.5), (4.0, 10.0)),
    "works": HouseMix((("hall", 0.6), ("terrace", 0.2), ("flats", 0.2)), (2.0, 5.0), (3.0, 9.0)),
    "mixed": HouseMix((("terrace", 0.35), ("villa", 0.25), ("flats", 0.25), ("shop", 0.15)), (0.8, 3.5), (0.0, 4.0)),
}
_PANELS = tuple(style.name for style in STYLES if style.wall == "panels")
_OTHERS = tuple(style.name for style in STYLES if style.wall != "panels")
_LOW = tuple(style.name for style in STYLES if style.wall in ("timber", "planks"))
_TREES = ("lime", "maple", "beech", "oak", "birch", "poplar", "young")
_FENCES = ("hedge", "wall", "boards", "pickets", "rails")


@dataclass(frozen=True, slots=True)
class Character:
    """How one side of a street looks.

    mix: key of `MIXES`. styles: walls, the first ones most often; panels: often of blocks of flats. tree_m, lamp_m:
    spacing along the street. poles: wires on wooden poles instead of lamps.
    """

    mix: str
    styles: tuple[str, ...]
    panels: str
    roofs: tuple[str, ...]
    trees: tuple[str, ...]
    tree_m: float
    lamp: str
    lamp_m: float
    fence: str
    paving: str
    poles: bool

    def style(self, rng: np.random.Generator, storeys: int) -> str:
        """A wall for the next house; nobody builds high of wood."""
        style = self.styles[int(rng.choice(len(self.styles), p=(0.5, 0.3, 0.2)))]
        return self.panels if style in _LOW and storeys > 3 else style


def draw_characters(rng: np.random.Generator, streets: int) -> list[tuple[Character, Character]]:
    """Left and right side of each street; neighbours along the loop never share their mix."""
    names = list(MIXES)
    characters = []
    before = ("", "")
    for _ in range(streets):
        left = str(rng.choice([name for name in names if name not in before]))
        right = left if rng.random() < 0.35 else str(rng.choice([name for name in names if name not in before]))
        paving, lamp = str(rng.choice(PAVINGS)), str(rng.choice(["tall_lamp", "lantern"]))
        characters.append((_side(rng, left, paving, lamp, False), _side(rng, right, paving, lamp, rng.random() < 0.3)))
        before = (left, right)
    return characters


def _side(rng: np.random.Generator, mix: str, paving: str, lamp: str, poles: bool) -> Character:
    def some(names: tuple[str, ...], count: int) -> tuple[str, ...]:
        return tuple(str(name) for name in rng.choice(names, count, replace=False))

    return Character(
        mix=mix,
        styles=some(_OTHERS, 3),
        panels=some(_PANELS, 1)[0],
        roofs=some(TOWN_ROOFS, 2),
        trees=some(_TREES, 2),
        tree_m=float(rng.choice([9.0, 14.0, 20.0, 32.0])),
        lamp=lamp,
        lamp_m=float(rng.uniform(24.0, 34.0)) if lamp == "tall_lamp" else float(rng.uniform(17.0, 22.0)),
        fence=some(_FENCES, 1)[0],
        paving=paving,
        poles=poles,
    )
