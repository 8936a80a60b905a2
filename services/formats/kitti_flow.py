# SPDX-License-Identifier: Apache-2.0
"""KITTI's optical flow: a PNG of three 16-bit channels, u * 64 + 2^15, v * 64 + 2^15, and whether there is a flow.

Source: KITTI's stereo/flow devkit (readme.txt).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.formats.png import described, read_png, write_png
from services.runtime.errors import InputError

STEPS_PER_PX = 64.0
_ZERO = 2**15
_LARGEST = 2**16 - 1


@dataclass(frozen=True)
class FlowImage:
    """Where the pixels of one image are in the next.

    `flow`, float32 (H, W, 2), px to the right and down, 0 where `valid`, bool (H, W), says that nothing is known.
    """

    flow: npt.NDArray[np.float32]
    valid: npt.NDArray[np.bool_]


def read_kitti_flow(path: Path) -> FlowImage:
    """Read one image. Raises InputError for what is no PNG of three 16-bit channels."""
    pixels = read_png(path, "KITTI flow: a PNG of three channels of 16 bits")
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.dtype != np.uint16:
        raise InputError(f"{path}: {described(pixels)}, expected KITTI flow: three channels of 16 bits")
    valid = pixels[..., 2] != 0
    flow = (pixels[..., :2].astype(np.float32) - _ZERO) / np.float32(STEPS_PER_PX)
    flow[~valid] = 0.0
    return FlowImage(flow, valid)


def write_kitti_flow(path: Path, image: FlowImage) -> None:
    """Write one image, to the nearest 1/64 px; a flow beyond KITTI's +-512 px, or no number, becomes invalid."""
    scaled = np.rint(image.flow.astype(np.float64) * STEPS_PER_PX) + _ZERO
    fits = image.valid & np.isfinite(scaled).all(axis=2) & (scaled >= 0).all(axis=2) & (scaled <= _LARGEST).all(axis=2)
    pixels = np.zeros((*image.valid.shape, 3), dtype=np.uint16)
    pixels[fits, :2] = scaled[fits].astype(np.uint16)
    pixels[fits, 2] = 1
    write_png(path, pixels)
