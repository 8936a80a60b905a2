# SPDX-License-Identifier: Apache-2.0
"""KITTI MoSeg, first release: masks of cars, and boxes that say which of them move (Siam et al., MODNet, ITSC 2018).

`{training,testing}/images/NAME.png`, `mask/NAME.png` and `boxes/NAME.txt`, where NAME is a drive and its frame. A mask
is 0 where there is no car. A line of boxes is `id moving y1 x1 y2 x2 [class ...]`: moving 1 or 0, the corners in px.
The fields are those that the extended release documents; readers of the first one agree on the corners.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.formats.png import read_png
from services.formats.text_rows import TextRow, read_rows
from services.runtime.errors import InputError

SPLITS = ("testing", "training")
_FEWEST_FIELDS = 6
_LINE = "a line of 'id moving y1 x1 y2 x2'"
_EXPECTED = "expected KITTI MoSeg's images/*.png, mask/*.png and boxes/*.txt in training/ and testing/, or in itself"


@dataclass(frozen=True)
class MovingBox:
    """One car's box, corners in pixels with x1 < x2 and y1 < y2, and whether the car moves."""

    moving: bool
    x1: float
    y1: float
    x2: float
    y2: float


@dataclass(frozen=True)
class MosegFrame:
    """One frame's files."""

    name: str
    mask: Path
    boxes: Path


def moseg_frames(data: Path, split: str | None) -> list[MosegFrame]:
    """The frames of one split, or of `data` itself where it holds mask/ and boxes/; `split` None: of testing.

    Raises:
        InputError: another layout, or a mask without its boxes.
    """
    folder = data if split is None and (data / "mask").is_dir() else data / (split or SPLITS[0])
    masks = sorted((folder / "mask").glob("*.png"))
    if not masks or not (folder / "boxes").is_dir():
        extended = "; Text_data_Output and the like are of the extended release" if _is_extended(data) else ""
        raise InputError(f"--data {data}: no such data set, {_EXPECTED}{extended}")
    frames = [MosegFrame(mask.stem, mask, folder / "boxes" / f"{mask.stem}.txt") for mask in masks]
    for frame in frames:
        if not frame.boxes.is_file():
            raise InputError(f"{frame.boxes}: no such file, expected the boxes of {frame.mask.name}")
    return frames


def read_cars(frame: MosegFrame) -> npt.NDArray[np.uint8]:
    """The mask of all cars, (H, W). Values above 0 are cars; where there are several, each is a car of its own.

    Raises:
        InputError: what is no PNG of 8 bits, or colours that are not grey.
    """
    pixels = read_png(frame.mask, "a mask of cars, 8 bits")
    if pixels.ndim == 3:
        if not (pixels[..., :1] == pixels).all():
            raise InputError(f"{frame.mask}: colours, expected a grey mask: 0, and more than 0 where a car is")
        pixels = pixels[..., 0]
    if pixels.ndim != 2 or pixels.dtype != np.uint8:
        raise InputError(f"{frame.mask}: {pixels.shape} {pixels.dtype}, expected one channel of 8 bits")
    return np.asarray(pixels, dtype=np.uint8)


def read_boxes(frame: MosegFrame) -> tuple[MovingBox, ...]:
    """The boxes of one frame; one without an area is passed over, as the data set has some.

    Raises:
        InputError: fewer fields, a moving flag other than 0 and 1, or a corner that is no number; names file and line.
    """
    boxes = []
    for row in read_rows(frame.boxes, _LINE):
        if len(row.fields) < _FEWEST_FIELDS:
            raise InputError(f"{frame.boxes}:{row.line}: {len(row.fields)} fields, expected {_LINE}")
        y1, x1, y2, x2 = (row.real(index, name) for index, name in enumerate(("y1", "x1", "y2", "x2"), start=2))
        moving = _flag(row)
        if x2 > x1 and y2 > y1:
            boxes.append(MovingBox(moving, x1, y1, x2, y2))
    return tuple(boxes)


def _flag(row: TextRow) -> bool:
    value = row.real(1, "moving")
    if value not in (0.0, 1.0):
        raise row.error("moving", row.fields[1], "0 or 1")
    return value == 1.0


def _is_extended(data: Path) -> bool:
    return any(data.glob("Text_data_Output")) or any(data.glob("*/Text_data_Output"))
