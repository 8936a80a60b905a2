# SPDX-License-Identifier: Apache-2.0
"""The textures that the town has beside those of `library`, by name, all painted from the seed."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import cv2
import numpy as np

from services.simulator.painting import town_surfaces
from services.simulator.painting.buildings import shopfronts, storeys
from services.simulator.painting.buildings.shopfronts import BOARDS, MURALS, POSTERS, SHOPS
from services.simulator.painting.library import paint_shared
from services.simulator.painting.surfaces import Image, coloured, leaves, noise, roof_tiles, speckle, to_image
from services.simulator.painting.traffic_library import paint_traffic

TOWN_SIGNS = 6
ARROWS = 2
PAVINGS = ("paving", "setts_grey", "setts_red")
TOWN_ROOFS = ("roof_red", "roof_brown", "roof_grey", "roof_slate", "roof_moss")


def paint_town_library(seed: int) -> dict[str, Image]:
    """All textures of the town, those it shares with the street among them, name to BGR uint8 image."""
    painters: dict[str, Callable[[np.random.Generator], Image]] = {
        "setts_grey": lambda rng: town_surfaces.setts(rng, (138.0, 142.0, 146.0)),
        "setts_red": lambda rng: town_surfaces.setts(rng, (104.0, 116.0, 158.0)),
        "gravel": town_surfaces.gravel,
        "cladding_grey": lambda rng: town_surfaces.corrugated(rng, (160.0, 160.0, 158.0)),
        "cladding_blue": lambda rng: town_surfaces.corrugated(rng, (152.0, 116.0, 84.0)),
        "gate": town_surfaces.gate,
        "hedge": town_surfaces.hedge,
        "roof_slate": lambda rng: roof_tiles(rng, (84.0, 76.0, 72.0)),
        "roof_moss": lambda rng: roof_tiles(rng, (66.0, 96.0, 104.0)),
        "leaves_birch": lambda rng: leaves(rng, (70, 158, 140)),
        "leaves_copper": lambda rng: leaves(rng, (58, 62, 108)),
        "needles": lambda rng: town_surfaces.needles(rng, (58.0, 86.0, 52.0)),
        "birch_bark": town_surfaces.birch_bark,
        "railing_white": lambda rng: town_surfaces.railing(rng, (190.0, 194.0, 196.0)),
        "railing_green": lambda rng: town_surfaces.railing(rng, (120.0, 150.0, 110.0)),
        "iron": lambda rng: speckle(rng, (52.0, 54.0, 50.0), 7.0),
        "paint_red": lambda rng: speckle(rng, (44.0, 40.0, 176.0), 9.0),
        "paint_yellow": lambda rng: speckle(rng, (40.0, 180.0, 220.0), 9.0),
        "paint_green": lambda rng: speckle(rng, (62.0, 96.0, 50.0), 9.0),
        "timetable": town_surfaces.timetable,
        "traffic_light": town_surfaces.lamp_glass,
    }
    for style in storeys.STYLES:
        painters[f"storeys_{style.name}"] = partial(storeys.paint_storeys, style=style)
        painters[f"plain_{style.name}"] = partial(storeys.paint_plain, style=style)
    for k in range(SHOPS):
        painters[f"shop_{k}"] = partial(shopfronts.paint_shop, number=k)
    for k in range(BOARDS):
        painters[f"board_{k}"] = partial(shopfronts.paint_board, number=k)
    for k in range(POSTERS):
        painters[f"poster_{k}"] = shopfronts.paint_poster
    for k in range(MURALS):
        painters[f"mural_{k}"] = shopfronts.paint_mural
    for k in range(TOWN_SIGNS):
        painters[f"town_sign_{k}"] = partial(_sign, kind=k)
    for k in range(ARROWS):
        painters[f"arrow_{k}"] = partial(town_surfaces.arrow, kind=k)
    own = {name: paint(np.random.default_rng([seed, 23, *name.encode()])) for name, paint in painters.items()}
    return paint_shared(seed) | own | paint_traffic(seed)


def _sign(rng: np.random.Generator, kind: int) -> Image:
    """Give way, zebra crossing, no entry, a place's name, a street's name, one way."""
    canvas = to_image(coloured(noise(rng, 128, 128, [(20, 6.0)]), (150.0, 152.0, 152.0)))
    red, blue, white, black = (40.0, 30.0, 190.0), (170.0, 80.0, 30.0), (236.0, 238.0, 238.0), (20.0, 20.0, 20.0)
    name = "".join(chr(int(c)) for c in rng.integers(65, 91, 6))
    if kind == 0:
        cv2.fillPoly(canvas, [np.array([[2, 8], [125, 8], [64, 124]])], red)
        cv2.fillPoly(canvas, [np.array([[26, 22], [101, 22], [64, 92]])], white)
    elif kind == 1:
        cv2.rectangle(canvas, (2, 2), (125, 125), blue, -1)
        cv2.fillPoly(canvas, [np.array([[64, 14], [118, 112], [10, 112]])], white)
        cv2.line(canvas, (64, 44), (64, 80), black, 9)
        for x in (38, 64, 90):
            cv2.rectangle(canvas, (x - 8, 96), (x + 6, 110), black, -1)
    elif kind == 2:
        cv2.circle(canvas, (64, 64), 61, red, -1)
        cv2.rectangle(canvas, (18, 52), (110, 76), white, -1)
    elif kind == 3:
        cv2.rectangle(canvas, (2, 2), (125, 125), (40.0, 190.0, 235.0), -1)
        cv2.putText(canvas, name[:5], (8, 60), cv2.FONT_HERSHEY_DUPLEX, 1.1, black, 3)
        cv2.putText(canvas, f"{int(rng.integers(2, 40))} km", (16, 104), cv2.FONT_HERSHEY_DUPLEX, 0.9, black, 2)
    elif kind == 4:
        cv2.rectangle(canvas, (2, 34), (125, 96), blue, -1)
        cv2.putText(canvas, name, (8, 76), cv2.FONT_HERSHEY_DUPLEX, 0.9, white, 2)
    else:
        cv2.rectangle(canvas, (2, 34), (125, 96), blue, -1)
        cv2.arrowedLine(canvas, (12, 65), (116, 65), white, 14, tipLength=0.4)
    return canvas
