# SPDX-License-Identifier: Apache-2.0
"""Depth, instances and motion as colours."""

from __future__ import annotations

import colorsys

import cv2
import numpy as np
import numpy.typing as npt

Picture = npt.NDArray[np.uint8]

_NEAR_M, _FAR_M = 1.5, 80.0
_SKY, _NOBODY = 235, 30
_GREEN, _RED = (60, 170, 40), (40, 40, 225)
_TINT = 0.6
_GOLDEN = 0.618034
"""Steps of this share of the circle keep any number of neighbouring hues apart."""


def depth_colours(depth_m: npt.NDArray[np.float32]) -> Picture:
    """Picture (H, W, 3), blue-green-red, of a depth (H, W): by its logarithm, red is near and blue far; sky is pale."""
    share = np.log(_FAR_M / np.clip(depth_m, _NEAR_M, _FAR_M)) / np.log(_FAR_M / _NEAR_M)
    picture: Picture = np.asarray(cv2.applyColorMap(np.rint(share * 255.0).astype(np.uint8), cv2.COLORMAP_TURBO))
    picture[depth_m <= 0.0] = _SKY
    return picture


def instance_colours(labels: npt.NDArray[np.uint16]) -> Picture:
    """Picture (H, W, 3), blue-green-red, of labels (H, W): each id a hue of its own, nobody dark."""
    ids, places = np.unique(labels, return_inverse=True)
    palette = [
        colorsys.hsv_to_rgb(number * _GOLDEN % 1.0, 0.65 + number % 3 * 0.15, 1.0 - number % 4 * 0.1)[::-1]
        for number in ids.tolist()
    ]
    picture = np.rint(np.array(palette) * 255.0).astype(np.uint8)[places.reshape(labels.shape)]
    picture[labels == 0] = _NOBODY
    return picture


def moving_tint(image: Picture, labels: npt.NDArray[np.uint16], moving: frozenset[int]) -> Picture:
    """The image (H, W, 3), blue-green-red and paler, with what stands in green and what moves in red."""
    grey = cv2.cvtColor(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR).astype(np.float64)
    picture = 0.65 * grey + 0.35 * 255.0
    moves = np.isin(labels, list(moving))
    for mask, colour in ((moves, _RED), ((labels > 0) & ~moves, _GREEN)):
        picture[mask] = (1.0 - _TINT) * grey[mask] + _TINT * np.array(colour)
    return np.rint(picture).astype(np.uint8)
