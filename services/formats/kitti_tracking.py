# SPDX-License-Identifier: Apache-2.0
"""KITTI tracking: boxes of objects whose ids last, one line an object and frame; and AB3DMOT's detections.

Source: KITTI's tracking devkit (readme.txt); the detections are those that come with Weng et al., "3D Multi-Object
Tracking: A Baseline and New Evaluation Metrics", IROS 2020: frame, type, box, score, dimensions, location, rotation,
alpha, separated by commas, without ids.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from services.formats.text_rows import TextRow, read_rows
from services.runtime.errors import InputError

DONT_CARE = "DontCare"
"""Type of a region that nobody labelled; its id is -1."""
NO_ID = -1

_LABEL = "17 fields (frame id type truncated occluded alpha box4 size3 place3 rotation_y) or 18 with a score"
_DETECTION = "15 fields (frame, type, box4, score, size3, place3, rotation_y, alpha)"
_FARTHEST_PX = 1e6
_TYPES_OF_DETECTIONS = {1: "Pedestrian", 2: "Car", 3: "Cyclist"}


@dataclass(frozen=True)
class TrackedBox:
    """One object in one frame, in the left colour camera's frame (x right, y down, z forward).

    `box_px` is left, top, right, bottom; `size_m` height, width, length; `place_m` the middle of its bottom.
    `truncated` is 0..2, `occluded` 0 (seen whole) to 3 (unknown), both -1 where nobody said. Angles are in radians.
    """

    frame: int
    object_id: int
    category: str
    box_px: tuple[float, float, float, float]
    truncated: float = NO_ID
    occluded: int = NO_ID
    alpha: float = -10.0
    size_m: tuple[float, float, float] = (-1000.0, -1000.0, -1000.0)
    place_m: tuple[float, float, float] = (-1000.0, -1000.0, -1000.0)
    rotation_y: float = -10.0
    score: float | None = None


def read_kitti_tracking(path: Path) -> tuple[TrackedBox, ...]:
    """Read a sequence's labels or results; a file without lines is a sequence without objects.

    Raises:
        InputError: no such file, a line with another number of fields, a field that is no number, a box that is none,
            or an id twice in a frame; names file, line, field, what was found and expected.
    """
    boxes = []
    seen: set[tuple[int, int]] = set()
    for row in read_rows(path, f"KITTI tracking labels: {_LABEL}"):
        box = _label(row)
        if box.object_id != NO_ID:
            if (box.frame, box.object_id) in seen:
                raise row.error("id", str(box.object_id), f"each id once in frame {box.frame}")
            seen.add((box.frame, box.object_id))
        boxes.append(box)
    return tuple(boxes)


def write_kitti_tracking(path: Path, boxes: Iterable[TrackedBox]) -> None:
    """Write labels as the devkit reads them, ordered by frame and id; the score stands there where it is known."""
    ordered = sorted(boxes, key=lambda box: (box.frame, box.object_id))
    path.write_text("".join(f"{_line(box)}\n" for box in ordered), encoding="ascii")


def read_detections(path: Path) -> tuple[TrackedBox, ...]:
    """Read detections without ids (`NO_ID`); their scores are the network's logits, not probabilities.

    Raises:
        InputError: as for `read_kitti_tracking`.
    """
    return tuple(_detection(row) for row in read_rows(path, f"detections: {_DETECTION}", delimiter=","))


def _label(row: TextRow) -> TrackedBox:
    if len(row.fields) not in (17, 18):
        raise InputError(f"{row.path}:{row.line}: {len(row.fields)} fields, expected {_LABEL}")
    return TrackedBox(
        frame=row.whole(0, "frame", 0),
        object_id=row.whole(1, "id", NO_ID),
        category=row.fields[2],
        truncated=row.real(3, "truncated"),
        occluded=round(row.real(4, "occluded")),
        alpha=row.real(5, "alpha"),
        box_px=_box(row, 6),
        size_m=_three(row, 10, "size"),
        place_m=_three(row, 13, "place"),
        rotation_y=row.real(16, "rotation_y"),
        score=row.real(17, "score") if len(row.fields) == 18 else None,
    )


def _detection(row: TextRow) -> TrackedBox:
    if len(row.fields) != 15:
        raise InputError(f"{row.path}:{row.line}: {len(row.fields)} fields, expected {_DETECTION}")
    number = row.whole(1, "type")
    if number not in _TYPES_OF_DETECTIONS:
        raise row.error(
            "type", row.fields[1], ", ".join(f"{key} ({name})" for key, name in _TYPES_OF_DETECTIONS.items())
        )
    return TrackedBox(
        frame=row.whole(0, "frame", 0),
        object_id=NO_ID,
        category=_TYPES_OF_DETECTIONS[number],
        box_px=_box(row, 2),
        score=row.real(6, "score"),
        size_m=_three(row, 7, "size"),
        place_m=_three(row, 10, "place"),
        rotation_y=row.real(13, "rotation_y"),
        alpha=row.real(14, "alpha"),
    )


def _box(row: TextRow, start: int) -> tuple[float, float, float, float]:
    left, top, right, bottom = (
        row.real(start + offset, f"box {side}") for offset, side in enumerate(("left", "top", "right", "bottom"))
    )
    if max(map(abs, (left, top, right, bottom))) > _FARTHEST_PX:
        raise row.error("box", " ".join(row.fields[start : start + 4]), f"pixels up to {_FARTHEST_PX:g}")
    if right < left or bottom < top:
        raise row.error("box", " ".join(row.fields[start : start + 4]), "left top right bottom with left < right")
    return left, top, right, bottom


def _three(row: TextRow, start: int, name: str) -> tuple[float, float, float]:
    return row.real(start, name), row.real(start + 1, name), row.real(start + 2, name)


def _line(box: TrackedBox) -> str:
    numbers = [box.alpha, *box.box_px, *box.size_m, *box.place_m, box.rotation_y]
    if box.score is not None:
        numbers.append(box.score)
    head = f"{box.frame} {box.object_id} {box.category} {box.truncated:g} {box.occluded}"
    return " ".join((head, *(f"{number:.6f}" for number in numbers)))
