# SPDX-License-Identifier: Apache-2.0
"""Labelled points as PCD 0.7 (the Point Cloud Library's format) and PLY (Turk, Stanford 1994), read."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from schemas.records import MotionState
from services.formats.pcd import parse_pcd
from services.formats.ply import parse_ply
from services.runtime.errors import InputError

LABEL_FIELDS = ("state", "label")
_FARTHEST_M = 1e9
_MOST_VOXELS = 2**62
_PARSERS = {".pcd": parse_pcd, ".ply": parse_ply}


@dataclass(frozen=True)
class LabelledPoints:
    """`position` (N, 3) float64; `state` (N,) uint8 of MotionState. `name` says in errors which points are meant.

    Raises InputError for positions that are not finite or beyond 10^9 m, or not as many as the states.
    """

    position: npt.NDArray[np.float64]
    state: npt.NDArray[np.uint8]
    name: str = "points"

    def __post_init__(self) -> None:
        count = len(self.state)
        if self.position.shape != (count, 3):
            raise InputError(f"{self.name}: positions of shape {self.position.shape}, expected ({count}, 3)")
        broken = ~np.isfinite(self.position).all(axis=1)
        if broken.any():
            raise InputError(f"{self.name}: point {int(np.argmax(broken)) + 1} of {count} is not finite")
        far = (np.abs(self.position) > _FARTHEST_M).any(axis=1)
        if far.any():
            row = int(np.argmax(far))
            largest = float(np.abs(self.position[row]).max())
            raise InputError(
                f"{self.name}: point {row + 1} of {count} is at {largest:.3g} m, expected at most {_FARTHEST_M:g}"
            )

    def __len__(self) -> int:
        return len(self.state)

    def chosen(self, rows: npt.NDArray[np.bool_]) -> "LabelledPoints":
        """Those where `rows` (N,) is true."""
        return LabelledPoints(self.position[rows], self.state[rows], self.name)


def read_points(path: Path) -> LabelledPoints:
    """x, y, z and `state` (or `label`) of every point, other fields left out; the name's ending tells the format.

    Raises InputError for a file that is missing, of another format, cut off, without one of these, or with NaN.
    """
    parse = _PARSERS.get(path.suffix.lower())
    if parse is None:
        raise InputError(f"{path}: expected points in a file whose name ends in .pcd or .ply")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}), expected points (.pcd or .ply)") from None
    table = parse(path, data)
    names = table.dtype.names or ()
    label = next((name for name in LABEL_FIELDS if name in names), None)
    missing = [name for name in "xyz" if name not in names]
    if missing or label is None:
        raise InputError(f"{path}: has the fields {' '.join(names)}, expected x, y, z and state (a MotionState)")
    unknown = ~np.isin(table[label], list(MotionState))
    if unknown.any():
        row = int(np.argmax(unknown))
        raise InputError(f"{path}: {label} {table[label][row]} of point {row + 1}, expected a MotionState, 0 to 4")
    position = np.stack([table[name].astype(np.float64) for name in "xyz"], axis=1)
    return LabelledPoints(position, table[label].astype(np.uint8), str(path))


def first_in_voxels(
    position: npt.NDArray[np.floating[Any]], state: npt.NDArray[np.uint8], voxel_m: float
) -> npt.NDArray[np.intp]:
    """The rows (M,), increasing, of the first point of every state in every cube of `voxel_m`.

    `position` is (N, 3) in metres, `state` (N,) of MotionState. Raises InputError for cubes so small that 62 bits
    cannot number them.
    """
    if len(state) == 0:
        return np.empty(0, dtype=np.intp)
    cells = np.floor(position / voxel_m)
    cells -= cells.min(axis=0)
    size = cells.max(axis=0) + 1
    with np.errstate(over="ignore"):  # infinitely many are too many
        voxels = float(np.prod(size.astype(np.float64)))
    if not voxels * len(MotionState) <= _MOST_VOXELS:
        extent = " x ".join(f"{side * voxel_m:.3g}" for side in size.tolist())
        raise InputError(f"voxel {voxel_m:g} m, expected a larger one for points over {extent} m")
    voxel, sides = cells.astype(np.int64), size.astype(np.int64)
    key = ((voxel[:, 0] * sides[1] + voxel[:, 1]) * sides[2] + voxel[:, 2]) * len(MotionState) + state
    first: npt.NDArray[np.intp] = np.sort(np.unique(key, return_index=True)[1])
    return first
