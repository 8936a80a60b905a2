# SPDX-License-Identifier: Apache-2.0
"""Cloth in light grey, tinted later, faces and skin of the town's people."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

from services.simulator.painting.lettering import write
from services.simulator.painting.surfaces import Colour, Floats32, Image, coloured, noise, to_image
from services.simulator.shapes.townspeople import FACES

_SKINS: tuple[Colour, ...] = ((140.0, 168.0, 212.0), (112.0, 142.0, 190.0), (76.0, 100.0, 144.0), (50.0, 66.0, 98.0))
_HAIR: tuple[Colour, ...] = (
    (36.0, 50.0, 70.0),
    (60.0, 130.0, 190.0),
    (28.0, 28.0, 30.0),
    (24.0, 24.0, 26.0),
    (150.0, 152.0, 154.0),
    (40.0, 66.0, 130.0),
)


def cloth_painters() -> dict[str, Callable[[np.random.Generator], Image]]:
    """Painters by the texture's name."""
    painters: dict[str, Callable[[np.random.Generator], Image]] = {
        "cloth_plain": lambda rng: to_image(_cloth(rng)),
        "cloth_striped": _striped,
        "cloth_checked": _checked,
        "cloth_knit": _knit,
        "cloth_print": _print,
        "jeans_grey": _jeans,
        "skin_tinted": lambda rng: to_image(coloured(noise(rng, 32, 32, [(6, 10)]), (222.0, 222.0, 222.0))),
    }
    for number in range(FACES):
        painters[f"face_{number}"] = lambda rng, number=number: _face(rng, number)  # type: ignore[misc]
    return painters


def _jeans(rng: np.random.Generator) -> Image:
    return to_image(coloured(noise(rng, 64, 64, [(4, 26), (14, 24), (40, 14)]), (200.0, 200.0, 200.0)))


def _cloth(rng: np.random.Generator) -> Floats32:
    """Folds, a zip and pockets."""
    canvas = coloured(noise(rng, 128, 128, [(5, 22), (14, 22), (50, 14)]), (205.0, 205.0, 205.0))
    cv2.line(canvas, (32, 0), (32, 127), (60.0, 60.0, 60.0), 2)
    for y in (74, 92):
        cv2.rectangle(canvas, (12, y), (26, y + 10), (80.0, 80.0, 80.0), 2)
    return canvas


def _striped(rng: np.random.Generator) -> Image:
    canvas = _cloth(rng)
    canvas[np.arange(128) % 21 < 8] *= 0.5
    return to_image(canvas)


def _checked(rng: np.random.Generator) -> Image:
    canvas = _cloth(rng)
    canvas[:, np.arange(128) % 24 < 7] *= 0.62
    canvas[np.arange(128) % 24 < 7] *= 0.62
    return to_image(canvas)


def _knit(rng: np.random.Generator) -> Image:
    canvas = _cloth(rng)
    rows, columns = np.mgrid[0:128, 0:128]
    canvas *= (0.8 + 0.2 * np.cos(2.0 * np.pi * (rows / 8.0 + np.abs(columns % 16 - 8) / 8.0)))[..., None]
    return to_image(canvas)


def _print(rng: np.random.Generator) -> Image:
    canvas = _cloth(rng)
    for x, y in rng.integers(0, 128, (14, 2)):
        cv2.circle(canvas, (int(x), int(y)), int(rng.integers(4, 10)), (90.0, 90.0, 90.0), -1)
    cv2.rectangle(canvas, (52, 24), (116, 60), (245.0, 245.0, 245.0), -1)
    write(canvas, str(int(rng.integers(10, 99))), (60, 54), 23, (50.0, 50.0, 50.0), bold=3)
    return to_image(canvas)


def _face(rng: np.random.Generator, number: int) -> Image:
    """Head unrolled: face on both edges, hair between and on top."""
    skin, hair_colour = _SKINS[number % len(_SKINS)], _HAIR[number % len(_HAIR)]
    face = coloured(noise(rng, 64, 64, [(10, 8)]), skin)
    hair = coloured(noise(rng, 64, 64, [(12, 20)]), hair_colour)
    low = 62 if number % 2 else 44
    face[:24], face[:low, 16:48] = hair[:24], hair[:low, 16:48]
    for x in (4, 60):
        cv2.circle(face, (x, 30), 3, (30.0, 30.0, 30.0), -1)
    cv2.line(face, (0, 42), (4, 42), (60.0, 60.0, 130.0), 2)
    cv2.line(face, (60, 42), (63, 42), (60.0, 60.0, 130.0), 2)
    return to_image(face)
