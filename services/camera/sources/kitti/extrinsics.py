# SPDX-License-Identifier: Apache-2.0
"""How KITTI's sensors sit on the car: lines `R: <9 numbers>`, `T: <3 numbers>` and `Tr_velo_cam <12 numbers>`."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.camera.sources.folders.number_rows import parse_numbers, read_lines
from services.runtime.errors import InputError

Array = npt.NDArray[np.float64]

# KITTI writes seven digits.
_TOLERANCE = 1e-3


class KittiValues:
    """The named numbers of a calibration file. Raises InputError for a file that cannot be read."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._lines = {}
        for line_number, line in read_lines(path):
            name, *numbers = line.split(maxsplit=1)
            self._lines[name.rstrip(":")] = (line_number, "".join(numbers))

    def transform(self, *names: str) -> Array:
        """(4, 4) of the first of `names` that is there: 3x4 or 3x3 numbers by rows.

        Raises:
            InputError: none of them is there, other numbers, or numbers that are no rotation.
        """
        name = next((name for name in names if name in self._lines), names[0])
        count = 9 if name.startswith("R") else 12
        matrix = np.eye(4)
        matrix[:3, : count // 3] = np.reshape(self.numbers(name, count), (3, count // 3))
        rotation = matrix[:3, :3]
        if not (np.allclose(rotation @ rotation.T, np.eye(3), atol=_TOLERANCE) and np.linalg.det(rotation) > 0):
            raise InputError(f"{self._path} line {self._lines[name][0]}: {name} is no rotation, expected one")
        return matrix

    def rotation_and_translation(self) -> Array:
        """(4, 4) of the lines R and T. Raises InputError."""
        matrix = self.transform("R")
        matrix[:3, 3] = self.numbers("T", 3)
        return matrix

    def numbers(self, name: str, count: int) -> list[float]:
        """The `count` numbers of the line `name`. Raises InputError."""
        if name not in self._lines:
            raise InputError(f"{self._path}: no line '{name}', expected one with {count} numbers")
        line_number, numbers = self._lines[name]
        return parse_numbers(self._path, line_number, numbers, count)
