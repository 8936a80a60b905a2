# SPDX-License-Identifier: Apache-2.0
"""The textures of an office floor by name, all painted from the seed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from services.simulator.painting.indoor.furniture import books, cupboard, machine, radiator, screen
from services.simulator.painting.indoor.prints import badge, exit_sign, notice_board, poster
from services.simulator.painting.indoor.rooms import carpet, ceiling, door, painted_wall, tiles, window
from services.simulator.painting.surfaces import Colour, Image, coloured, leaves, noise, planks, speckle, to_image
from services.simulator.shapes import people

POSTER_COUNT, DOOR_COUNT, SCREEN_COUNT, WALL_COUNT = 10, 3, 4, 3
_DOORS: tuple[Colour, ...] = ((92, 128, 168), (150, 140, 120), (96, 116, 84))
_WALLS: tuple[Colour, ...] = ((206, 218, 222), (196, 208, 202), (214, 206, 190))


def paint_indoor_library(seed: int) -> dict[str, Image]:
    """All textures of a corridor, name to BGR uint8 image; each has a generator of its own."""
    painters: dict[str, Callable[[np.random.Generator], Image]] = {
        "carpet": carpet,
        "tiles": tiles,
        "ceiling": ceiling,
        "lamp": lambda rng: to_image(coloured(noise(rng, 64, 64, [(4, 3), (32, 3)]), (250.0, 252.0, 250.0))),
        "window": window,
        "wood": lambda rng: to_image(planks(rng, (88, 132, 176), 256, 256, 4)),
        "plastic": lambda rng: speckle(rng, (196, 198, 196), 6.0),
        "dark": lambda rng: speckle(rng, (52, 50, 48), 8.0),
        "steel": lambda rng: speckle(rng, (150, 150, 148), 9.0),
        "red": lambda rng: speckle(rng, (44, 40, 186), 9.0),
        "fabric": lambda rng: to_image(coloured(noise(rng, 64, 64, [(8, 8), (32, 16), (64, 12)]), (120, 76, 52))),
        "plant": lambda rng: leaves(rng, (56, 128, 84)),
        "pot": lambda rng: speckle(rng, (70, 96, 150), 10.0),
        "notice_board": notice_board,
        "radiator": radiator,
        "machine": machine,
        "cupboard": cupboard,
        "books": books,
        "exit_sign": exit_sign,
    }
    textures = {name: paint(_generator(seed, name)) for name, paint in painters.items()}
    for kind in range(WALL_COUNT):
        textures[f"wall_{kind}"] = painted_wall(_generator(seed, f"wall_{kind}"), _WALLS[kind])
    for kind in range(DOOR_COUNT):
        textures[f"door_{kind}"] = door(_generator(seed, f"door_{kind}"), _DOORS[kind], kind)
    for kind in range(POSTER_COUNT):
        textures[f"poster_{kind}"] = poster(_generator(seed, f"poster_{kind}"))
    for kind in range(SCREEN_COUNT):
        textures[f"screen_{kind}"] = screen(_generator(seed, f"screen_{kind}"))
    textures |= people.paint_clothes(_generator(seed, "clothes"))
    textures["rubber"] = speckle(_generator(seed, "rubber"), (40, 40, 42), 6.0)
    textures["plate"] = badge(_generator(seed, "plate"))
    return textures


def _generator(seed: int, name: str) -> np.random.Generator:
    return np.random.default_rng([seed, 12, *name.encode()])
