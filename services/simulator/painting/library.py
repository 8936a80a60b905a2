# SPDX-License-Identifier: Apache-2.0
"""The textures of a street by name, all painted from the seed."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

from services.simulator.painting import surfaces
from services.simulator.painting.buildings import facades
from services.simulator.painting.surfaces import Image, coloured, noise, to_image
from services.simulator.painting.vehicles import vehicle_textures
from services.simulator.shapes import people
from services.simulator.shapes.vehicles import cars

SIGN_COUNT = 4
ROOFS = ("roof_red", "roof_brown", "roof_grey")


def paint_library(seed: int) -> dict[str, Image]:
    """All textures of the street, name to BGR uint8 image; each has a generator of its own, so that one more changes no
    other."""
    fronts = {f"facade_{style.name}": style for style in facades.STYLES}
    houses = {name: facades.paint_facade(_generator(seed, name), style) for name, style in fronts.items()}
    return _paint_surfaces(seed) | houses | _paint_things(seed)


def paint_shared(seed: int) -> dict[str, Image]:
    """The street's textures without its houses, for a world that has others."""
    return _paint_surfaces(seed) | _paint_things(seed)


def _paint_surfaces(seed: int) -> dict[str, Image]:
    """Grounds, plants, roofs, plain materials, road paint, sky."""
    painters: dict[str, Callable[[np.random.Generator], Image]] = {
        "asphalt": surfaces.asphalt,
        "paving": surfaces.paving,
        "grass": surfaces.grass,
        "leaves_light": lambda rng: surfaces.leaves(rng, (64, 138, 108)),
        "leaves_dark": lambda rng: surfaces.leaves(rng, (48, 98, 70)),
        "leaves_olive": lambda rng: surfaces.leaves(rng, (58, 120, 122)),
        "bark": surfaces.bark,
        "roof_red": lambda rng: surfaces.roof_tiles(rng, (62, 78, 150)),
        "roof_brown": lambda rng: surfaces.roof_tiles(rng, (60, 72, 96)),
        "roof_grey": lambda rng: surfaces.roof_tiles(rng, (98, 92, 88)),
        "wall": lambda rng: to_image(surfaces.bricks(rng, (84, 102, 148), 256, 256, 22)),
        "boards": lambda rng: to_image(surfaces.planks(rng, (96, 126, 150), 128, 128, 8)),
        "metal": lambda rng: surfaces.speckle(rng, (112, 112, 108), 9.0),
        "bin": lambda rng: surfaces.speckle(rng, (66, 70, 58), 7.0),
        "worn_paint": surfaces.worn_paint,
        "patch": surfaces.patch,
        "manhole": surfaces.manhole,
        "tree_line": surfaces.tree_line,
        "clouds": surfaces.clouds,
    }
    return {name: paint(_generator(seed, name)) for name, paint in painters.items()}


def _paint_things(seed: int) -> dict[str, Image]:
    """Vehicles, clothes and traffic signs."""
    textures = {}
    for body in cars.STYLES:
        name = f"side_{body.name}"
        textures[name] = vehicle_textures.paint_side(_generator(seed, name), body)
    textures |= vehicle_textures.paint_parts(_generator(seed, "car parts"))
    textures |= people.paint_clothes(_generator(seed, "clothes"))
    for kind in range(SIGN_COUNT):
        textures[f"sign_{kind}"] = _sign(_generator(seed, f"sign_{kind}"), kind)
    return textures


def _generator(seed: int, name: str) -> np.random.Generator:
    return np.random.default_rng([seed, 2, *name.encode()])


def _sign(rng: np.random.Generator, kind: int) -> Image:
    """Speed limit, no parking, priority, parking, on a grey back."""
    canvas = to_image(coloured(noise(rng, 128, 128, [(20, 6)]), (150.0, 152.0, 152.0)))
    red, blue, white, black = (40.0, 30.0, 190.0), (170.0, 80.0, 30.0), (236.0, 238.0, 238.0), (20.0, 20.0, 20.0)
    if kind == 0:
        cv2.circle(canvas, (64, 64), 60, red, -1)
        cv2.circle(canvas, (64, 64), 44, white, -1)
        cv2.putText(canvas, "30", (30, 82), cv2.FONT_HERSHEY_SIMPLEX, 1.7, black, 6)
    elif kind == 1:
        cv2.circle(canvas, (64, 64), 60, red, -1)
        cv2.circle(canvas, (64, 64), 48, blue, -1)
        cv2.line(canvas, (26, 26), (102, 102), red, 13)
    elif kind == 2:
        diamond = np.array([[64, 2], [126, 64], [64, 126], [2, 64]], np.int32)
        cv2.fillPoly(canvas, [diamond], white)
        cv2.fillPoly(canvas, [((diamond - 64) * 0.68 + 64).astype(np.int32)], (30.0, 190.0, 236.0))
    else:
        cv2.rectangle(canvas, (4, 4), (123, 123), blue, -1)
        cv2.putText(canvas, "P", (34, 102), cv2.FONT_HERSHEY_SIMPLEX, 3.2, white, 11)
    return canvas
