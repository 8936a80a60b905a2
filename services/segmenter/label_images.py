# SPDX-License-Identifier: Apache-2.0
"""Backend `masks`: instances that somebody found before, as one label image a frame and a list of what they are.

A folder holds `<frame name>.png` (0 = background, i = instance i; 8 or 16 bits, one channel) and `instances.json`:
`{"<frame name>": [{"id": i, "category": "car", "score": 0.73}, ...], ...}` with COCO's names.
"""

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from schemas.records import Image, Instances
from services.runtime.errors import InputError
from services.segmenter.backend import Candidate, FrameContext, InstanceFilter, skipped_frame

INDEX_NAME = "instances.json"
_ROW = '{"id": 1, "category": "car", "score": 0.73}'
_LARGEST_LABEL = 65535


class LabelImages:
    """Reads a folder of label images; a frame that it does not have is skipped and counted.

    Raises:
        InputError: no folder, no instances.json in it, or one that is not as above; names frame, found and expected.
    """

    def __init__(self, folder: Path, chosen: InstanceFilter) -> None:
        if not folder.is_dir():
            raise InputError(f"instances {folder}: no such folder, expected label images and {INDEX_NAME}")
        self._folder = folder
        self._filter = chosen
        self._candidates = _read_index(folder / INDEX_NAME)
        self.missing_frames = 0

    def segment(self, image: Image, context: FrameContext) -> Instances:
        candidates = self._candidates.get(context.frame_name)
        path = self._folder / f"{context.frame_name}.png"
        if candidates is None or not path.is_file():
            self.missing_frames += 1
            return skipped_frame(image)
        return self._filter.choose(image.timestamp_ns, _read_labels(path, image.pixels.shape[:2]), candidates)

    def close(self) -> None:
        """Nothing is held open."""


def _read_labels(path: Path, shape: tuple[int, ...]) -> npt.NDArray[np.unsignedinteger]:
    try:
        data = np.frombuffer(path.read_bytes(), dtype=np.uint8)
        labels = cv2.imdecode(data, cv2.IMREAD_UNCHANGED)
    except OSError as error:
        raise InputError(f"label image {path}: cannot be read ({error.strerror})") from error
    except cv2.error:
        labels = None
    if labels is None:
        raise InputError(f"label image {path}: not a readable image, expected a whole PNG file")
    if labels.ndim != 2 or labels.dtype not in (np.uint8, np.uint16):
        raise InputError(f"label image {path}: {labels.shape} {labels.dtype}, expected one channel of 8 or 16 bits")
    if labels.shape != shape:
        raise InputError(
            f"label image {path}: {labels.shape[1]}x{labels.shape[0]} px, expected {shape[1]}x{shape[0]} as its image"
        )
    return np.asarray(labels, dtype=np.uint16)


def _read_index(path: Path) -> dict[str, tuple[Candidate, ...]]:
    if not path.is_file():
        raise InputError(f"instances {path.parent}: no {INDEX_NAME}, expected one beside the label images")
    try:
        index = json.loads(path.read_bytes())
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except (json.JSONDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise InputError(f"{path}: not JSON ({error})") from error
    if not isinstance(index, dict):
        raise InputError(f"{path}: a {type(index).__name__}, expected an object of frame names")
    return {name: _parse_rows(path, name, rows) for name, rows in index.items()}


def _parse_rows(path: Path, frame_name: str, rows: Any) -> tuple[Candidate, ...]:
    if not isinstance(rows, list):
        raise InputError(f"{path} frame {frame_name}: {_short(rows)}, expected a list of {_ROW}")
    candidates = tuple(_parse_row(path, frame_name, row) for row in rows)
    if len({candidate.label for candidate in candidates}) != len(candidates):
        raise InputError(f"{path} frame {frame_name}: an id stands there twice, expected each once")
    return candidates


def _parse_row(path: Path, frame_name: str, row: Any) -> Candidate:
    match row:
        case {"id": int(label), "category": str(category), "score": int() | float() as score} if (
            0 < label <= _LARGEST_LABEL and 0.0 <= score <= 1.0 and label is not True
        ):
            return Candidate(label, category, float(score))
    raise InputError(f"{path} frame {frame_name}: {_short(row)}, expected such as {_ROW}")


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
