# SPDX-License-Identifier: Apache-2.0
"""The project's own `instances/` folders: one PNG label image a frame and `instances.json` that says what they show.

`<frame name>.png` holds 0 for background, i for instance i (one channel, 8 or 16 bits); `instances.json` holds
`{"<frame name>": [{"id": i, "category": "car", "score": 0.73}, ...], ...}` with COCO's names, and where it is known
`"moving": true`. Whether an id lasts from frame to frame is for the folder's maker to say.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from services.formats.json_file import read_json, shortened, write_json
from services.formats.png import described, read_png, write_png
from services.runtime.errors import InputError

INDEX_NAME = "instances.json"
LARGEST_LABEL = 65535
_ROW = '{"id": 1, "category": "car", "score": 0.73}'


@dataclass(frozen=True)
class LabelledInstance:
    """One instance of a frame: its pixel value, what it is, how sure that is (0..1), and whether it moves if known."""

    label: int
    category: str
    score: float = 1.0
    moving: bool | None = None


def read_label_image(path: Path) -> npt.NDArray[np.uint16]:
    """One label image (H, W). Raises InputError for what is no PNG of one channel of 8 or 16 bits."""
    labels = read_png(path, "a label image: one channel of 8 or 16 bits")
    if labels.ndim != 2 or labels.dtype not in (np.uint8, np.uint16):
        raise InputError(f"{path}: {described(labels)}, expected one channel of 8 or 16 bits")
    return np.asarray(labels, dtype=np.uint16)


def write_label_image(path: Path, labels: npt.NDArray[np.integer[Any]]) -> None:
    """Write labels (H, W), with 8 bits where they fit. Raises InputError for labels outside 0..65535."""
    lowest, highest = (int(labels.min()), int(labels.max())) if labels.size else (0, 0)
    if lowest < 0 or highest > LARGEST_LABEL:
        raise InputError(f"{path}: label {lowest if lowest < 0 else highest}, expected 0..{LARGEST_LABEL}")
    write_png(path, labels.astype(np.uint8 if highest < 256 else np.uint16))


def read_label_index(folder: Path) -> dict[str, tuple[LabelledInstance, ...]]:
    """The instances of every frame, by the frame's name, in the file's order.

    Raises:
        InputError: no folder, no instances.json in it, or one that is not as above; names frame, found and expected.
    """
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder, expected label images and {INDEX_NAME}")
    path = folder / INDEX_NAME
    index = read_json(path, f"an object of frame names, each with a list of {_ROW}")
    if not isinstance(index, dict):
        raise InputError(f"{path}: a {type(index).__name__}, expected an object of frame names")
    return {name: _parse_rows(f"{path} frame {name}", rows) for name, rows in index.items()}


def write_label_index(folder: Path, index: Mapping[str, Sequence[LabelledInstance]]) -> None:
    """Write `instances.json`."""
    write_json(folder / INDEX_NAME, {name: [_row(item) for item in items] for name, items in index.items()})


def _row(item: LabelledInstance) -> dict[str, Any]:
    row: dict[str, Any] = {"id": item.label, "category": item.category, "score": item.score}
    if item.moving is not None:
        row["moving"] = item.moving
    return row


def _parse_rows(place: str, rows: Any) -> tuple[LabelledInstance, ...]:
    if not isinstance(rows, list):
        raise InputError(f"{place}: {shortened(rows)}, expected a list of {_ROW}")
    instances = tuple(_parse_row(place, row) for row in rows)
    if len({instance.label for instance in instances}) != len(instances):
        raise InputError(f"{place}: an id stands there twice, expected each once")
    return instances


def _parse_row(place: str, row: Any) -> LabelledInstance:
    match row:
        case {"id": int(label), "category": str(category)} if 0 < label <= LARGEST_LABEL and label is not True:
            score, moving = row.get("score", 1.0), row.get("moving")
            if type(score) in (int, float) and 0.0 <= score <= 1.0 and (moving is None or isinstance(moving, bool)):
                return LabelledInstance(label, category, float(score), moving)
    raise InputError(f"{place}: {shortened(row)}, expected such as {_ROW}")
