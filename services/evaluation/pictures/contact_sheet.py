# SPDX-License-Identifier: Apache-2.0
"""A contact sheet: frames of the simulator below each other, each with everything that is true of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

from services.evaluation.pictures.flow_colours import flow_colours
from services.evaluation.pictures.tints import depth_colours, instance_colours, moving_tint
from services.runtime.errors import ResourceError

Picture = npt.NDArray[np.uint8]

COLUMNS = (
    "image",
    "depth (near red, 80 m blue)",
    "instances",
    "moving red, standing green",
    "flow (black: not seen again)",
)
_LARGEST_BYTES = 1_500_000
_QUALITIES = (92, 88, 84, 80, 75, 70, 60, 50)
_WIDTH_PX, _GAP_PX, _HEAD_PX, _NAME_PX = 2500, 6, 40, 74
_INK, _PAPER = (40, 40, 40), 255


@dataclass(frozen=True, slots=True)
class SheetRow:
    """One frame.

    name: what stands beside it. image: blue-green-red (H, W, 3). depth_m: (H, W), 0 is sky. labels: (H, W), 0 is
    nobody. moving: ids of those that move. flow_px: (H, W, 2). flow_valid: (H, W), where the next frame shows it.
    """

    name: str
    image: Picture
    depth_m: npt.NDArray[np.float32]
    labels: npt.NDArray[np.uint16]
    moving: frozenset[int]
    flow_px: npt.NDArray[np.float32]
    flow_valid: npt.NDArray[np.bool_]

    def cells(self) -> tuple[Picture, ...]:
        """Blue-green-red pictures (H, W, 3) in the order of `COLUMNS`."""
        valid = self.flow_valid
        longest = float(np.percentile(np.linalg.norm(self.flow_px[valid], axis=1), 98)) if valid.any() else 1.0
        flow = flow_colours(self.flow_px, max(longest, 1e-3), valid)
        return (
            self.image,
            depth_colours(self.depth_m),
            instance_colours(self.labels),
            moving_tint(self.image, self.labels, self.moving),
            np.ascontiguousarray(flow[..., ::-1]),
        )


def draw_contact_sheet(rows: Sequence[SheetRow]) -> Picture:
    """The sheet, blue-green-red, at most 2500 px wide, its columns named above; `rows` one at least, of one size."""
    height, width = rows[0].image.shape[:2]
    cell_width = min(width, (_WIDTH_PX - _NAME_PX) // len(COLUMNS) - _GAP_PX)
    cell_height = round(height * cell_width / width)
    step_x, step_y = cell_width + _GAP_PX, cell_height + _GAP_PX
    sheet = np.full((_HEAD_PX + len(rows) * step_y, _NAME_PX + len(COLUMNS) * step_x, 3), _PAPER, np.uint8)
    for column, title in enumerate(COLUMNS):
        _write(sheet, title, (_NAME_PX + column * step_x + 4, _HEAD_PX - 13), 0.75)
    for number, row in enumerate(rows):
        top = _HEAD_PX + number * step_y
        for line, text in enumerate(row.name.split("\n")):
            _write(sheet, text, (4, top + 22 + 20 * line), 0.5)
        for column, cell in enumerate(row.cells()):
            left = _NAME_PX + column * step_x
            small = cv2.resize(cell, (cell_width, cell_height), interpolation=cv2.INTER_AREA)
            sheet[top : top + cell_height, left : left + cell_width] = small
    return sheet


def write_sheet(path: Path, sheet: Picture) -> None:
    """Write a JPEG of at most 1.5 MB, as good as fits. Raises ResourceError where the disk does not take it."""
    for quality in _QUALITIES:
        _, data = cv2.imencode(".jpg", sheet, [cv2.IMWRITE_JPEG_QUALITY, quality])
        if data.size <= _LARGEST_BYTES:
            break
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data.tobytes())
    except OSError as error:
        raise ResourceError(f"{path}: cannot be written ({error.strerror}), expected a file to write to") from error


def _write(sheet: Picture, text: str, place: tuple[int, int], scale: float) -> None:
    cv2.putText(sheet, text, place, cv2.FONT_HERSHEY_SIMPLEX, scale, _INK, 1, cv2.LINE_AA)
