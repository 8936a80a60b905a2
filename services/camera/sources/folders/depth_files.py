# SPDX-License-Identifier: Apache-2.0
"""Depth images as 16-bit PNG files."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.camera.sources.folders.image_header import read_image_size
from services.formats.png import read_png
from services.runtime.errors import InputError


class DepthFiles:
    """The depth images of `paths` by index, each of `size` (width, height), `per_metre` grey levels a metre.

    Raises:
        InputError: a file that is not there or no image, or of another size than the colour image it belongs to.
    """

    def __init__(self, paths: Sequence[Path], size: tuple[int, int], per_metre: float) -> None:
        self._paths = list(paths)
        self._per_metre = per_metre
        for path in self._paths:
            found = read_image_size(path)
            if found != size:
                raise InputError(
                    f"depth {path}: {found[0]}x{found[1]} px, expected {size[0]}x{size[1]} as the colour images"
                )

    def read(self, index: int) -> npt.NDArray[np.float32]:
        """(H, W) metres, 0 where there is none. Raises InputError for a file that is cut off or not 16 bits grey."""
        path = self._paths[index]
        levels = read_png(path, "a depth image of 16 bits")
        if levels.dtype != np.uint16 or levels.ndim != 2:
            raise InputError(f"depth {path}: {levels.dtype} of shape {levels.shape}, expected one channel of 16 bits")
        return levels.astype(np.float32) / np.float32(self._per_metre)
