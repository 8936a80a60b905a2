# SPDX-License-Identifier: Apache-2.0
"""Painted textures of an office floor: what covers it, what hangs on its walls, what stands in it."""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

from services.simulator.painting.surfaces import (
    Colour,
    Floats32,
    Image,
    coloured,
    leaves,
    noise,
    planks,
    speckle,
    to_image,
)
from services.simulator.shapes import people

POSTER_COUNT, DOOR_COUNT, SCREEN_COUNT, WALL_COUNT = 10, 3, 4, 3
_DOORS: tuple[Colour, ...] = ((92, 128, 168), (150, 140, 120), (96, 116, 84))
_WALLS: tuple[Colour, ...] = ((206, 218, 222), (196, 208, 202), (214, 206, 190))
_INK: Colour = (40.0, 38.0, 36.0)


def paint_indoor_library(seed: int) -> dict[str, Image]:
    """All textures of a corridor, name to BGR uint8 image; each has a generator of its own."""
    painters: dict[str, Callable[[np.random.Generator], Image]] = {
        "carpet": _carpet,
        "tiles": _tiles,
        "ceiling": _ceiling,
        "lamp": lambda rng: to_image(coloured(noise(rng, 64, 64, [(4, 3), (32, 3)]), (250.0, 252.0, 250.0))),
        "window": _window,
        "wood": lambda rng: to_image(planks(rng, (88, 132, 176), 256, 256, 4)),
        "plastic": lambda rng: speckle(rng, (196, 198, 196), 6.0),
        "dark": lambda rng: speckle(rng, (52, 50, 48), 8.0),
        "steel": lambda rng: speckle(rng, (150, 150, 148), 9.0),
        "red": lambda rng: speckle(rng, (44, 40, 186), 9.0),
        "fabric": lambda rng: to_image(coloured(noise(rng, 64, 64, [(8, 8), (32, 16), (64, 12)]), (120, 76, 52))),
        "plant": lambda rng: leaves(rng, (56, 128, 84)),
        "pot": lambda rng: speckle(rng, (70, 96, 150), 10.0),
        "notice_board": _notice_board,
        "radiator": _radiator,
        "machine": _machine,
        "cupboard": _cupboard,
        "books": _books,
        "exit_sign": _exit_sign,
    }
    textures = {name: paint(_generator(seed, name)) for name, paint in painters.items()}
    for kind in range(WALL_COUNT):
        textures[f"wall_{kind}"] = _painted_wall(_generator(seed, f"wall_{kind}"), _WALLS[kind])
    for kind in range(DOOR_COUNT):
        textures[f"door_{kind}"] = _door(_generator(seed, f"door_{kind}"), _DOORS[kind], kind)
    for kind in range(POSTER_COUNT):
        textures[f"poster_{kind}"] = _poster(_generator(seed, f"poster_{kind}"))
    for kind in range(SCREEN_COUNT):
        textures[f"screen_{kind}"] = _screen(_generator(seed, f"screen_{kind}"))
    textures |= people.paint_clothes(_generator(seed, "clothes"))
    textures["rubber"] = speckle(_generator(seed, "rubber"), (40, 40, 42), 6.0)
    textures["plate"] = _badge(_generator(seed, "plate"))
    return textures


def _generator(seed: int, name: str) -> np.random.Generator:
    return np.random.default_rng([seed, 12, *name.encode()])


def _carpet(rng: np.random.Generator, size: int = 512) -> Image:
    """Carpet tiles of half a metre, every other one turned, stained here and there. 4 m square."""
    value = noise(rng, size, size, [(6, 8), (24, 6), (256, 13), (512, 12)])
    step = size // 8
    for row in range(8):
        for column in range(8):
            cell = np.s_[row * step : (row + 1) * step, column * step : (column + 1) * step]
            value[cell] += 8.0 * ((row + column) % 2) + float(rng.uniform(-7, 7))
            stripe = np.arange(step) % 8 < 2
            if (row + column) % 2:
                value[cell][:, stripe] -= 14.0
            else:
                value[cell][stripe] -= 14.0
    for _ in range(14):
        centre = (int(rng.integers(0, size)), int(rng.integers(0, size)))
        cv2.circle(value, centre, int(rng.integers(3, 14)), float(rng.uniform(-40, 20)), -1)
    return to_image(coloured(value, (118.0, 104.0, 92.0)))


def _tiles(rng: np.random.Generator, size: int = 512) -> Image:
    """Floor tiles of half a metre with dark joints and veins. 4 m square."""
    value = noise(rng, size, size, [(5, 8), (16, 9), (64, 9), (256, 6)])
    step = size // 8
    for row in range(8):
        for column in range(8):
            value[row * step : (row + 1) * step, column * step : (column + 1) * step] += float(rng.uniform(-12, 12))
    for at in range(0, size, step):
        value[at : at + 2] -= 60.0
        value[:, at : at + 2] -= 60.0
    return to_image(coloured(value, (168.0, 176.0, 178.0)))


def _ceiling(rng: np.random.Generator, size: int = 256) -> Image:
    """Mineral panels of 60 cm with small holes in a metal grid. 2.4 m square."""
    value = noise(rng, size, size, [(4, 4), (64, 5), (256, 6)])
    for x, y in rng.integers(0, size, (420, 2)).tolist():
        cv2.circle(value, (x, y), 1, -48.0, -1)
    for at in range(0, size, size // 4):
        value[at : at + 2] -= 46.0
        value[:, at : at + 2] -= 46.0
    return to_image(coloured(value, (226.0, 230.0, 230.0)))


def _painted_wall(rng: np.random.Generator, colour: Colour, size: int = 512) -> Image:
    """Wood-chip paper under paint, with scuffs near the floor and a rail at hip height. 4 m wide, 2.8 m high."""
    value = noise(rng, size, size, [(4, 5), (12, 4), (128, 5), (256, 9)])
    for x, y in rng.integers(0, size, (900, 2)).tolist():
        cv2.circle(value, (x, y), int(rng.integers(1, 3)), float(rng.uniform(-16, 10)), -1)
    for _ in range(60):
        x, y = int(rng.integers(0, size)), int(rng.integers(int(0.78 * size), size))
        cv2.line(value, (x, y), (x + int(rng.integers(-30, 30)), y + int(rng.integers(-5, 5))), -38.0, 1)
    canvas = coloured(value, colour)
    rail = np.s_[int(0.66 * size) : int(0.69 * size)]
    canvas[rail] = coloured(noise(rng, size, size, [(64, 8), (256, 6)])[rail], (96.0, 126.0, 158.0))
    return to_image(canvas)


def _window(rng: np.random.Generator, size: int = 256) -> Image:
    """Two casements on a bright day: sky, a house across the yard, a tree."""
    down = np.linspace(0.0, 1.0, size, dtype=np.float32)[:, None, None]
    canvas = np.asarray(np.array([250, 240, 226], np.float32) * (1 - 0.12 * down) * np.ones((1, size, 1), np.float32))
    top = int(rng.uniform(0.35, 0.55) * size)
    canvas[top:] = coloured(noise(rng, size, size, [(16, 8), (64, 8)]), (190.0, 200.0, 214.0))[top:]
    for x in range(int(rng.integers(6, 20)), size, 38):
        cv2.rectangle(canvas, (x, top + 16), (x + 20, top + 46), (128.0, 122.0, 116.0), -1)
    green = coloured(noise(rng, size, size, [(20, 26), (60, 26)]), (96.0, 160.0, 120.0))
    centre = (int(rng.integers(30, size - 30)), int(0.8 * size))
    crown = cv2.circle(np.zeros((size, size), np.uint8), centre, int(rng.integers(36, 60)), 1, -1).astype(bool)
    canvas[crown] = green[crown]
    for x in (0, size // 2 - 7, size - 14):
        cv2.rectangle(canvas, (x, 0), (x + 14, size), (224.0, 226.0, 226.0), -1)
        cv2.line(canvas, (x + 14, 0), (x + 14, size), (150.0, 150.0, 150.0), 2)
    for y in (0, size - 14):
        cv2.rectangle(canvas, (0, y), (size, y + 14), (224.0, 226.0, 226.0), -1)
    return to_image(canvas)


def _door(rng: np.random.Generator, colour: Colour, kind: int, width: int = 128, height: int = 256) -> Image:
    """A door leaf with handle, plate and, by kind, a pane or panels."""
    canvas = coloured(noise(rng, height, width, [(4, 8), (16, 6), (200, 9)]), colour)
    cv2.rectangle(canvas, (3, 3), (width - 4, height - 1), _INK, 2)
    if kind == 0:
        cv2.rectangle(canvas, (34, 34), (94, 132), (206.0, 204.0, 196.0), -1)
        cv2.rectangle(canvas, (34, 34), (94, 132), (70.0, 74.0, 76.0), 3)
        cv2.line(canvas, (40, 120), (86, 44), (240.0, 240.0, 240.0), 3)
    else:
        for y in (26, 146) if kind == 1 else (40,):
            cv2.rectangle(canvas, (26, y), (102, y + 84), tuple(0.7 * c for c in colour), 3)
    cv2.rectangle(canvas, (106, 128), (116, 160), (180.0, 184.0, 186.0), -1)
    cv2.line(canvas, (94, 138), (112, 138), (90.0, 92.0, 94.0), 5)
    cv2.rectangle(canvas, (44, 12), (84, 26), (236.0, 238.0, 238.0), -1)
    number = f"{int(rng.integers(1, 5))}.{int(rng.integers(10, 60))}"
    _write(canvas, number, (46, 24), (0.42, 1), _INK)
    return to_image(canvas)


def _poster(rng: np.random.Generator, size: int = 256) -> Image:
    """A printed sheet: ground, shapes, a headline, lines of text."""
    canvas = coloured(noise(rng, size, size, [(3, 20), (12, 8)]), _colour(rng, 120.0))
    for _ in range(int(rng.integers(5, 11))):
        a, b = (tuple(int(v) for v in rng.integers(0, size, 2)) for _ in range(2))
        if rng.random() < 0.5:
            cv2.rectangle(canvas, a, b, _colour(rng), -1 if rng.random() < 0.7 else 5)
        else:
            cv2.circle(canvas, a, int(rng.integers(12, 60)), _colour(rng), -1 if rng.random() < 0.7 else 5)
    words = ("OPEN DAY", "ROBOTS", "SAFETY", "FLOOR 3", "WORKSHOP", "MEETING", "SUMMER", "MAPS", "COFFEE", "LIBRARY")
    cv2.rectangle(canvas, (0, 10), (size, 56), _colour(rng, 190.0), -1)
    headline = words[int(rng.integers(0, len(words)))]
    _write(canvas, headline, (12, 46), (1.3, 4), _INK)
    cv2.rectangle(canvas, (12, 176), (size - 13, 244), (238.0, 240.0, 240.0), -1)
    _lines(rng, canvas, (20, 184, size - 22, 240))
    cv2.rectangle(canvas, (0, 0), (size - 1, size - 1), _INK, 5)
    return to_image(canvas)


def _lines(rng: np.random.Generator, canvas: Floats32, box: tuple[int, int, int, int]) -> None:
    """Words too small to read, in rows."""
    left, top, right, bottom = box
    for y in range(top, bottom, 7):
        x = left
        while x < right - 6:
            width = int(rng.integers(4, 18))
            cv2.line(canvas, (x, y), (min(x + width, right), y), (90.0, 88.0, 86.0), 2)
            x += width + 5


def _write(canvas: Floats32, text: str, at: tuple[int, int], size: tuple[float, int], ink: Colour) -> None:
    """Smooth letters of `size` (scale, thickness), which OpenCV only draws into bytes."""
    cover = np.zeros(canvas.shape[:2], np.uint8)
    cv2.putText(cover, text, at, cv2.FONT_HERSHEY_SIMPLEX, size[0], 255, size[1], cv2.LINE_AA)
    share = cover[..., None].astype(np.float32) / 255.0
    canvas += share * (np.asarray(ink, np.float32) - canvas)


def _notice_board(rng: np.random.Generator, size: int = 256) -> Image:
    """Cork, with notes pinned over each other."""
    canvas = coloured(noise(rng, size, size, [(64, 18), (256, 22)]), (86.0, 132.0, 176.0))
    for _ in range(17):
        x, y = (int(v) for v in rng.integers(6, size - 62, 2))
        w, h = (int(v) for v in rng.integers(30, 60, 2))
        cv2.rectangle(canvas, (x, y), (x + w, y + h), _colour(rng, 170.0), -1)
        _lines(rng, canvas, (x + 4, y + 8, x + w - 4, y + h - 4))
        cv2.circle(canvas, (x + w // 2, y + 3), 3, _colour(rng), -1)
    cv2.rectangle(canvas, (0, 0), (size - 1, size - 1), (120.0, 130.0, 140.0), 9)
    return to_image(canvas)


def _radiator(rng: np.random.Generator, width: int = 256, height: int = 128) -> Image:
    value = noise(rng, height, width, [(6, 4), (64, 4)])
    value[:, np.arange(width) % 16 < 3] -= 74.0
    value[:6] -= 40.0
    value[-6:] -= 60.0
    return to_image(coloured(value, (226.0, 230.0, 230.0)))


def _machine(rng: np.random.Generator, width: int = 128, height: int = 256) -> Image:
    """Front of a vending machine: lit shelves of goods, a slot, buttons."""
    canvas = coloured(noise(rng, height, width, [(4, 10), (64, 6)]), (64.0, 48.0, 40.0))
    for y in range(26, 170, 28):
        cv2.rectangle(canvas, (10, y), (88, y + 22), (226.0, 228.0, 224.0), -1)
        for x in range(14, 84, 13):
            cv2.rectangle(canvas, (x, y + 5), (x + 9, y + 21), _colour(rng), -1)
    for y in range(40, 120, 14):
        for x in (96, 106, 116):
            cv2.circle(canvas, (x, y), 4, (196.0, 200.0, 200.0), -1)
    cv2.rectangle(canvas, (18, 196), (84, 224), (24.0, 22.0, 22.0), -1)
    return to_image(canvas)


def _cupboard(rng: np.random.Generator, size: int = 256) -> Image:
    """Two doors of a steel cupboard with handles, labels and a magnet or two."""
    canvas = coloured(noise(rng, size, size, [(4, 7), (32, 5), (256, 6)]), (150.0, 156.0, 150.0))
    cv2.line(canvas, (size // 2, 0), (size // 2, size), _INK, 3)
    cv2.rectangle(canvas, (2, 2), (size - 3, size - 3), (90.0, 92.0, 92.0), 4)
    for x in (size // 2 - 20, size // 2 + 12):
        cv2.rectangle(canvas, (x, 110), (x + 8, 150), (60.0, 60.0, 62.0), -1)
    for _ in range(5):
        x, y = (int(v) for v in rng.integers(20, size - 60, 2))
        cv2.rectangle(canvas, (x, y), (x + int(rng.integers(14, 44)), y + int(rng.integers(10, 40))), _colour(rng), -1)
    return to_image(canvas)


def _books(rng: np.random.Generator, size: int = 256) -> Image:
    """Four shelves of files and books."""
    canvas = np.full((size, size, 3), 46.0, np.float32)
    for shelf in range(4):
        x, floor = 4, (shelf + 1) * 64 - 6
        while x < size - 10:
            width, height = int(rng.integers(6, 18)), int(rng.integers(34, 54))
            cv2.rectangle(canvas, (x, floor - height), (x + width, floor), _colour(rng), -1)
            cv2.line(canvas, (x + width // 2, floor - height + 6), (x + width // 2, floor - 20), _colour(rng, 170.0), 2)
            x += width + int(rng.integers(1, 4))
        cv2.rectangle(canvas, (0, floor), (size, floor + 6), (120.0, 158.0, 190.0), -1)
    return to_image(canvas)


def _screen(rng: np.random.Generator, width: int = 256, height: int = 128) -> Image:
    """A monitor's picture: windows, text, a plot."""
    canvas = coloured(noise(rng, height, width, [(3, 16)]), _colour(rng, 60.0))
    for _ in range(3):
        x, y = int(rng.integers(4, width - 120)), int(rng.integers(4, height - 60))
        cv2.rectangle(canvas, (x, y), (x + 112, y + 56), (236.0, 236.0, 236.0), -1)
        cv2.rectangle(canvas, (x, y), (x + 112, y + 8), _colour(rng), -1)
        _lines(rng, canvas, (x + 6, y + 14, x + 104, y + 54))
    curve = np.cumsum(rng.normal(0.0, 5.0, 24)) + 90.0
    points = np.stack([np.linspace(130, 250, 24), np.clip(curve, 66, 122)], axis=1).astype(np.int32)
    cv2.rectangle(canvas, (126, 62), (252, 124), (30.0, 30.0, 30.0), -1)
    cv2.polylines(canvas, [points], False, (80.0, 230.0, 120.0), 2)
    cv2.rectangle(canvas, (0, 0), (width - 1, height - 1), (16.0, 16.0, 16.0), 5)
    return to_image(canvas)


def _exit_sign(rng: np.random.Generator, width: int = 128, height: int = 64) -> Image:
    canvas = coloured(noise(rng, height, width, [(4, 6)]), (90.0, 150.0, 40.0))
    _write(canvas, "EXIT", (12, 46), (1.4, 4), (240.0, 244.0, 240.0))
    return to_image(canvas)


def _badge(rng: np.random.Generator, size: int = 64) -> Image:
    canvas = coloured(noise(rng, size, size, [(6, 6)]), (230.0, 232.0, 232.0))
    _lines(rng, canvas, (8, 34, size - 8, size - 6))
    cv2.circle(canvas, (18, 18), 10, (120.0, 140.0, 180.0), -1)
    return to_image(canvas)


def _colour(rng: np.random.Generator, lift: float = 0.0) -> Colour:
    """Any colour, lighter by `lift`."""
    b, g, r = np.minimum(rng.uniform(20.0, 230.0, 3) * (1.0 - lift / 255.0) + lift, 250.0).tolist()
    return b, g, r
