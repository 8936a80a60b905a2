# SPDX-License-Identifier: Apache-2.0
"""From a camera's image to the network's input."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

MULTIPLE_PX = 32
MEAN_RGB = np.array([123.675, 116.28, 103.53], np.float32)
STD_RGB = np.array([58.395, 57.12, 57.375], np.float32)


@dataclass(frozen=True)
class NetworkInput:
    """An image as the network takes it, and how it came about."""

    pixels: npt.NDArray[np.float32]
    """(1, 3, H, W), RGB, ImageNet's mean and deviation taken out, zeros right and below"""
    resized_hw: tuple[int, int]
    """the part of H and W that shows the image"""
    original_hw: tuple[int, int]


def fitted_hw(height: int, width: int, box: tuple[int, int]) -> tuple[int, int]:
    """The largest size (height, width) of the same aspect that fits the box, long side to long side."""
    factor = min(max(box) / max(height, width), min(box) / min(height, width))
    return int(height * factor + 0.5), int(width * factor + 0.5)


def prepare(image: npt.NDArray[np.uint8], box: tuple[int, int]) -> NetworkInput:
    """Fit an image, (H, W, 3) BGR or (H, W) grey, into `box` (width, height) and normalise it."""
    if image.ndim == 2:
        image = np.asarray(cv2.cvtColor(image, cv2.COLOR_GRAY2BGR), np.uint8)
    original = (image.shape[0], image.shape[1])
    height, width = fitted_hw(*original, box)
    resized = cv2.resize(image, (width, height), interpolation=cv2.INTER_LINEAR)
    padded = np.zeros((1, 3, _rounded_up(height), _rounded_up(width)), np.float32)
    padded[0, :, :height, :width] = normalized(np.asarray(resized, np.uint8))
    return NetworkInput(padded, (height, width), original)


def normalized(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
    """(H, W, 3) BGR to (3, H, W) RGB without ImageNet's mean and in units of its deviation."""
    rgb = image[..., ::-1].astype(np.float32)
    return np.ascontiguousarray(((rgb - MEAN_RGB) / STD_RGB).transpose(2, 0, 1))


def _rounded_up(size_px: int) -> int:
    return -(-size_px // MULTIPLE_PX) * MULTIPLE_PX
