# SPDX-License-Identifier: Apache-2.0
"""Words on painted things."""

from __future__ import annotations

import cv2
import numpy as np

from services.simulator.painting.surfaces import Colour, Floats32


def write(canvas: Floats32, text: str, at: tuple[int, int], height_px: float, colour: Colour, *, bold: int = 2) -> None:
    """Write `text` into `canvas` (H, W, 3) in place; at: left end of the base line; height_px: of a capital letter."""
    ink = np.zeros(canvas.shape[:2], np.uint8)
    cv2.putText(ink, text, at, cv2.FONT_HERSHEY_DUPLEX, height_px / 21.0, 255, bold)
    canvas[ink > 0] = colour
