# SPDX-License-Identifier: Apache-2.0
"""A folder of image files as a sequence of images of one size."""

import re
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from services.camera.sources.folders.image_header import IMAGE_SUFFIXES, read_image_size
from services.runtime.errors import InputError


def list_images(folder: Path) -> list[Path]:
    """The folder's PNG and JPEG files, numbers in their names counted as numbers (frame2 before frame10)."""
    return sorted(
        (path for path in folder.iterdir() if path.suffix.lower() in IMAGE_SUFFIXES and not path.name.startswith(".")),
        key=_natural_order,
    )


def _natural_order(path: Path) -> tuple[tuple[tuple[int, int | str], ...], str]:
    parts = re.split(r"(\d+)", path.stem)
    return tuple((0, int(part)) if part.isdecimal() else (1, part) for part in parts), path.name


class ListedImages:
    """The images of `paths` by index, all of the size that the first one has.

    Raises:
        InputError: an image whose head is broken or tells another size.
    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self.paths = list(paths)
        self.size = read_image_size(self.paths[0])
        for path in self.paths[1:]:
            self._expect_size(path, read_image_size(path))

    def __len__(self) -> int:
        return len(self.paths)

    def name(self, index: int) -> str:
        """The file's name without suffix."""
        return self.paths[index].stem

    def read(self, index: int) -> npt.NDArray[np.uint8]:
        """The pixels, (H, W) grey or (H, W, 3) blue-green-red as the file has it; 16 bits are scaled to 8.

        The pixels stay as the sensor gave them: an EXIF orientation is not applied, since the calibration knows none.

        Raises:
            InputError: the file is cut off, broken, or was exchanged for one of another size.
        """
        path = self.paths[index]
        try:
            data = np.frombuffer(path.read_bytes(), dtype=np.uint8)
        except OSError as error:
            raise InputError(f"image {path}: cannot be read ({error.strerror})") from error
        try:
            pixels = cv2.imdecode(data, cv2.IMREAD_ANYCOLOR | cv2.IMREAD_IGNORE_ORIENTATION)
        except cv2.error:
            pixels = None
        if pixels is None:
            raise InputError(f"image {path}: not a readable image, expected a whole PNG or JPEG file")
        self._expect_size(path, (pixels.shape[1], pixels.shape[0]))
        return np.asarray(pixels, dtype=np.uint8)

    def _expect_size(self, path: Path, size: tuple[int, int]) -> None:
        if size != self.size:
            raise InputError(
                f"image {path}: {size[0]}x{size[1]} px, expected {self.size[0]}x{self.size[1]} "
                f"as in {self.paths[0].name}"
            )


class ImageFiles(ListedImages):
    """The images of `folder` in the order of their names.

    Raises:
        InputError: no folder, no image in it, or an image whose head is broken or tells another size.
    """

    def __init__(self, folder: Path) -> None:
        if not folder.is_dir():
            raise InputError(f"image folder {folder}: no such folder")
        paths = list_images(folder)
        if not paths:
            raise InputError(f"image folder {folder}: no images, expected files ending in {', '.join(IMAGE_SUFFIXES)}")
        super().__init__(paths)
