# SPDX-License-Identifier: Apache-2.0
"""Painted sides and ends of buses, lorries and delivery vans; each picture is a whole side, seen from beside it."""

from __future__ import annotations

import cv2
import numpy as np

from services.simulator.painting.lettering import write
from services.simulator.painting.surfaces import Colour, Floats32, Image, coloured, noise, to_image

_BUS_SIDE_PX = (1024, 256)
_BUS_LENGTH_M, _BUS_LOW_M, _BUS_HIGH_M = 10.8, 0.3, 2.98
_LIVERIES: tuple[tuple[Colour, Colour], ...] = (
    ((214.0, 220.0, 224.0), (40.0, 40.0, 190.0)),
    ((60.0, 190.0, 232.0), (150.0, 80.0, 30.0)),
    ((170.0, 96.0, 40.0), (226.0, 228.0, 228.0)),
)
_GLASS: Colour = (58.0, 54.0, 50.0)
_BLACK: Colour = (22.0, 22.0, 22.0)
_ADVERTS: tuple[tuple[Colour, Colour, str], ...] = (
    ((206.0, 210.0, 212.0), (40.0, 40.0, 170.0), "MEYER & SOHN"),
    ((90.0, 140.0, 40.0), (235.0, 238.0, 240.0), "FRISCHKOST"),
    ((150.0, 70.0, 30.0), (60.0, 200.0, 240.0), "NORD CARGO"),
    ((60.0, 60.0, 64.0), (70.0, 150.0, 240.0), "MOEBEL-HAUS"),
)
_FIRMS: tuple[tuple[Colour, str], ...] = (
    ((40.0, 40.0, 200.0), "ELEKTRO KRUSE"),
    ((60.0, 150.0, 60.0), "BLUMEN-EXPRESS"),
    ((180.0, 90.0, 30.0), "PAKET24"),
)


def _sheet(rng: np.random.Generator, size: tuple[int, int], colour: Colour) -> Floats32:
    """Painted metal, dirtier towards the bottom."""
    width, height = size
    canvas = coloured(noise(rng, height, width, [(6, 6.0), (24, 5.0), (90, 4.0)]), colour)
    dirt = np.interp(np.linspace(0.0, 1.0, height), [0.0, 0.7, 1.0], [1.04, 1.0, 0.72]).astype(np.float32)
    canvas *= dirt[:, None, None]
    return canvas


def _pane(rng: np.random.Generator, canvas: Floats32, box: tuple[int, int, int, int], colour: Colour = _GLASS) -> None:
    """A window (x0, y0, x1, y1) with something of the street mirrored in it."""
    x0, y0, x1, y1 = box
    glass = coloured(noise(rng, 64, 128, [(5, 26.0), (14, 16.0)]), colour)
    canvas[y0:y1, x0:x1] = cv2.resize(glass, (x1 - x0, y1 - y0))
    cv2.rectangle(canvas, (x0, y0), (x1, y1), _BLACK, 2)


def paint_bus_side(rng: np.random.Generator, livery: int, *, doors: bool) -> Image:
    """Side of a bus; its front is on the right where it has doors, on the left where it has none."""
    width, height = _BUS_SIDE_PX
    base, band = _LIVERIES[livery]
    canvas = _sheet(rng, _BUS_SIDE_PX, base)

    def at(x_m: float, z_m: float) -> tuple[int, int]:
        x = (x_m + 0.5 * _BUS_LENGTH_M) / _BUS_LENGTH_M * width
        return round(x), round((_BUS_HIGH_M - z_m) / (_BUS_HIGH_M - _BUS_LOW_M) * height)

    cv2.rectangle(canvas, at(-6.0, 0.75), at(6.0, 0.5), band, -1)
    swoosh = np.array([at(-5.4, 1.25), at(-1.0, 0.75), at(-5.4, 0.75)], np.int32)
    cv2.fillPoly(canvas, [swoosh], band)
    for k in range(7):
        x = -5.15 + 1.42 * k
        _pane(rng, canvas, (*at(x, 2.5), *at(x + 1.34, 1.32)))
        if k % 3 == 1:
            cv2.line(canvas, at(x + 0.1, 2.2), at(x + 1.24, 2.2), (96.0, 96.0, 96.0), 2)
        for head in range(2):
            if rng.random() < 0.55:
                cv2.circle(canvas, at(x + 0.38 + 0.6 * head, 1.5), 9, (90.0, 110.0, 140.0), -1)
    _pane(rng, canvas, (*at(4.85, 2.5), *at(5.36, 1.2)))
    for x in (-4.0, 0.5):
        cv2.line(canvas, at(x, 1.25), at(x, 0.35), (110.0, 110.0, 110.0), 2)
    for x in (-2.95, 2.75):
        cv2.circle(canvas, at(x, 0.42), round(0.6 / _BUS_LENGTH_M * width), _BLACK, -1)
    cv2.line(canvas, at(-6.0, 2.62), at(6.0, 2.62), (150.0, 150.0, 150.0), 2)
    if doors:
        write(canvas, "STADTBUS", at(-0.6, 0.88), 21, band)
        for x in (-1.45, 3.55):
            cv2.rectangle(canvas, at(x - 0.62, 2.6), at(x + 0.62, 0.34), _BLACK, -1)
            _pane(rng, canvas, (*at(x - 0.56, 2.5), *at(x - 0.04, 0.45)))
            _pane(rng, canvas, (*at(x + 0.04, 2.5), *at(x + 0.56, 0.45)))
        return to_image(canvas)
    # Only now the words: the front is on the left.
    canvas = _mirrored(canvas)
    paper, ink, text = _ADVERTS[int(rng.integers(0, len(_ADVERTS)))]
    cv2.rectangle(canvas, at(-1.8, 1.22), at(2.6, 0.56), paper, -1)
    write(canvas, text, at(-1.5, 0.74), 27, ink, bold=3)
    return to_image(canvas)


def _mirrored(canvas: Floats32) -> Floats32:
    return np.ascontiguousarray(canvas[:, ::-1])


def paint_bus_front(rng: np.random.Generator, livery: int) -> Image:
    """Windscreen, destination, lamps."""
    base, band = _LIVERIES[livery]
    canvas = _sheet(rng, (256, 256), base)
    cv2.rectangle(canvas, (4, 2), (251, 44), _BLACK, -1)
    text = f"{int(rng.integers(1, 99))} " + ("RATHAUS", "BAHNHOF", "HAFEN")[livery]
    write(canvas, text, (18, 34), 20, (40.0, 190.0, 250.0), bold=2)
    _pane(rng, canvas, (6, 46, 250, 158), (70.0, 64.0, 58.0))
    cv2.ellipse(canvas, (182, 150), (22, 40), 0, 180, 360, (40.0, 44.0, 60.0), -1)
    for x in (60, 150):
        cv2.line(canvas, (x, 156), (x + 50, 128), _BLACK, 3)
    cv2.rectangle(canvas, (0, 166), (255, 186), band, -1)
    for x in (34, 222):
        cv2.circle(canvas, (x, 208), 15, (60.0, 60.0, 60.0), -1)
        cv2.circle(canvas, (x, 208), 12, (238.0, 240.0, 240.0), -1)
    cv2.rectangle(canvas, (90, 200), (166, 216), (225.0, 225.0, 225.0), -1)
    write(canvas, f"B {int(rng.integers(100, 999))}", (98, 213), 9, _BLACK, bold=1)
    cv2.rectangle(canvas, (0, 236), (255, 255), (50.0, 50.0, 50.0), -1)
    return to_image(canvas)


def paint_bus_back(rng: np.random.Generator, livery: int) -> Image:
    """Window, number, engine's grille, lamps."""
    base, band = _LIVERIES[livery]
    canvas = _sheet(rng, (256, 256), base)
    _pane(rng, canvas, (22, 22, 234, 98))
    cv2.rectangle(canvas, (150, 28), (222, 58), _BLACK, -1)
    write(canvas, str(int(rng.integers(1, 99))), (164, 54), 20, (40.0, 190.0, 250.0), bold=2)
    cv2.rectangle(canvas, (0, 108), (255, 124), band, -1)
    advert = _ADVERTS[(livery + 1) % len(_ADVERTS)]
    cv2.rectangle(canvas, (36, 130), (220, 168), advert[0], -1)
    write(canvas, advert[2], (44, 156), 14, advert[1], bold=2)
    cv2.rectangle(canvas, (50, 176), (206, 226), (44.0, 44.0, 44.0), -1)
    for y in range(180, 224, 7):
        cv2.line(canvas, (54, y), (202, y), (96.0, 96.0, 96.0), 2)
    for x in (8, 226):
        cv2.rectangle(canvas, (x, 172), (x + 22, 222), (40.0, 36.0, 190.0), -1)
        cv2.rectangle(canvas, (x, 188), (x + 22, 202), (40.0, 150.0, 240.0), -1)
    cv2.rectangle(canvas, (96, 232), (160, 248), (225.0, 225.0, 225.0), -1)
    return to_image(canvas)


def paint_lorry_side(rng: np.random.Generator, number: int) -> Image:
    """A box with its owner's name, the same from both sides."""
    base, ink, name = _ADVERTS[number]
    canvas = _sheet(rng, (512, 256), base)
    cv2.ellipse(canvas, (110, 128), (74, 74), 0, 0, 360, ink, 14)
    cv2.circle(canvas, (110, 128), 34, ink, -1)
    write(canvas, name, (196, 128), 26, ink, bold=3)
    write(canvas, f"TEL 0{int(rng.integers(200, 999))} {int(rng.integers(10000, 99999))}", (200, 178), 17, ink, bold=2)
    cv2.rectangle(canvas, (0, 0), (511, 255), (90.0, 90.0, 90.0), 6)
    for x in range(64, 512, 64):
        cv2.line(canvas, (x, 0), (x, 255), (base[0] * 0.9, base[1] * 0.9, base[2] * 0.9), 1)
    cv2.line(canvas, (0, 236), (511, 236), (40.0, 40.0, 200.0), 6)
    return to_image(canvas)


def paint_delivery_side(rng: np.random.Generator, firm: int, *, doors: bool) -> Image:
    """Side of a delivery van in light grey, tinted later: cab window, sliding door, name; front as on buses."""
    colour, name = _FIRMS[firm]
    canvas = _sheet(rng, (512, 256), (222.0, 222.0, 222.0))
    _pane(rng, canvas, (372, 44, 442, 116))
    cv2.rectangle(canvas, (362, 40), (450, 210), (130.0, 130.0, 130.0), 2)
    if doors:
        cv2.rectangle(canvas, (250, 22), (352, 208), (120.0, 120.0, 120.0), 3)
        cv2.rectangle(canvas, (258, 118), (270, 126), _BLACK, -1)
    words = np.zeros((256, 512), np.uint8)
    cv2.circle(words, (70, 160), 34, 255, 12)
    cv2.line(words, (120, 172), (340, 150), 255, 7)
    canvas[words > 0] = colour
    cv2.line(canvas, (0, 206), (511, 206), (70.0, 70.0, 70.0), 10)
    for x in (99, 417):
        cv2.circle(canvas, (x, 254), 42, _BLACK, -1)
    if not doors:
        canvas = _mirrored(canvas)
    write(canvas, name, (22 if doors else 170, 96), 20 if len(name) > 8 else 36, colour, bold=3)
    return to_image(canvas)


def paint_cab_side(rng: np.random.Generator, *, right: bool) -> Image:
    """Side of a lorry's cab in light grey, tinted later."""
    canvas = _sheet(rng, (256, 256), (214.0, 214.0, 214.0))
    _pane(rng, canvas, (110, 40, 214, 124))
    cv2.rectangle(canvas, (98, 30), (226, 214), (110.0, 110.0, 110.0), 3)
    cv2.rectangle(canvas, (106, 136), (128, 146), _BLACK, -1)
    cv2.circle(canvas, (150, 262), 74, _BLACK, -1)
    for y in (190, 206):
        cv2.line(canvas, (96, y), (226, y), (80.0, 80.0, 80.0), 3)
    return to_image(canvas if right else _mirrored(canvas))


def paint_cab_front(rng: np.random.Generator) -> Image:
    """Windscreen, grille, lamps of a lorry in light grey, tinted later."""
    canvas = _sheet(rng, (256, 256), (214.0, 214.0, 214.0))
    _pane(rng, canvas, (14, 46, 242, 126), (66.0, 62.0, 58.0))
    cv2.rectangle(canvas, (12, 14), (244, 42), (70.0, 70.0, 70.0), -1)
    cv2.rectangle(canvas, (58, 140), (198, 196), (36.0, 36.0, 36.0), -1)
    for y in range(146, 196, 9):
        cv2.line(canvas, (62, y), (194, y), (130.0, 130.0, 130.0), 3)
    cv2.circle(canvas, (128, 166), 12, (215.0, 215.0, 215.0), -1)
    for x in (14, 208):
        cv2.rectangle(canvas, (x, 206), (x + 34, 230), (238.0, 240.0, 240.0), -1)
        cv2.rectangle(canvas, (x, 206), (x + 34, 230), _BLACK, 2)
    cv2.rectangle(canvas, (92, 210), (164, 228), (228.0, 228.0, 228.0), -1)
    cv2.rectangle(canvas, (0, 236), (255, 255), (48.0, 48.0, 48.0), -1)
    return to_image(canvas)


def paint_doors(rng: np.random.Generator, colour: Colour, *, windows: bool) -> Image:
    """Two wings of a back door with hinges, bars and lamps."""
    canvas = _sheet(rng, (256, 256), colour)
    cv2.line(canvas, (128, 0), (128, 236), _BLACK, 3)
    if windows:
        for x in (26, 146):
            _pane(rng, canvas, (x, 34, x + 84, 96))
    else:
        for x in (92, 164):
            cv2.line(canvas, (x, 8), (x, 232), (120.0, 120.0, 120.0), 5)
            cv2.rectangle(canvas, (x - 12, 128), (x + 12, 138), (70.0, 70.0, 70.0), -1)
    for y in (30, 110, 190):
        for x in (4, 240):
            cv2.rectangle(canvas, (x, y), (x + 12, y + 16), (80.0, 80.0, 80.0), -1)
    for x in (4, 230):
        cv2.rectangle(canvas, (x, 148 if windows else 216), (x + 22, 200 if windows else 232), (40.0, 36.0, 190.0), -1)
    cv2.rectangle(canvas, (98, 206), (158, 224), (228.0, 228.0, 228.0), -1)
    cv2.rectangle(canvas, (0, 238), (255, 255), (52.0, 52.0, 52.0), -1)
    return to_image(canvas)


def paint_bumper(rng: np.random.Generator) -> Image:
    """Red and white stripes."""
    canvas = coloured(noise(rng, 32, 128, [(8, 8.0)]), (220.0, 222.0, 222.0))
    for x in range(0, 160, 40):
        cv2.fillPoly(canvas, [np.array([[x, 0], [x + 20, 0], [x, 32], [x - 20, 32]])], (40.0, 40.0, 196.0))
    return to_image(canvas)


def paint_plain(rng: np.random.Generator, colour: Colour) -> Image:
    """Sheet metal with seams."""
    canvas = _sheet(rng, (128, 128), colour)
    for x in (0, 64):
        cv2.line(canvas, (x, 0), (x, 127), (120.0, 120.0, 120.0), 2)
    return to_image(canvas)


def paint_glass(rng: np.random.Generator) -> Image:
    """A car's windscreen or rear window: sky mirrored in its upper part, head rests and a mirror behind it."""
    canvas = coloured(noise(rng, 128, 128, [(3, 14.0), (9, 12.0), (24, 8.0)]), (62.0, 58.0, 54.0))
    for x in (34, 94):
        cv2.rectangle(canvas, (x - 9, 62), (x + 9, 84), (30.0, 30.0, 32.0), -1)
        cv2.rectangle(canvas, (x - 20, 88), (x + 20, 127), (38.0, 36.0, 36.0), -1)
    cv2.rectangle(canvas, (56, 10), (72, 17), (24.0, 24.0, 26.0), -1)
    shine = np.interp(np.arange(128.0), [0.0, 40.0, 100.0], [0.62, 0.28, 0.06]).astype(np.float32)[:, None, None]
    sky = coloured(noise(rng, 128, 128, [(3, 18.0), (7, 14.0)]), (196.0, 176.0, 158.0))
    canvas = canvas * (1.0 - shine) + sky * shine
    cv2.rectangle(canvas, (0, 0), (127, 127), (26.0, 26.0, 26.0), 2)
    return to_image(canvas)
