# SPDX-License-Identifier: Apache-2.0
"""What the files over a whole sequence need of one frame: kept beside it, so that a data set can be gone on with."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from services.formats.json_file import read_json, write_json
from services.formats.kitti_tracking import TrackedBox
from services.formats.rle import Rle
from services.runtime.errors import InputError
from services.simulator.data_sets.whole_file import WrittenFile


@dataclass(frozen=True, slots=True)
class ObjectTruth:
    """One object with a pixel in sight. `box` is how KITTI's tracking says it; None for who rides on another."""

    object_id: int
    category: str
    moving: bool
    mask: Rle
    box: TrackedBox | None


@dataclass(frozen=True, slots=True)
class FrameTruth:
    """A finished frame: its own files, and all that the sequence's files say of it.

    k: (3, 3), the camera's matrix, px.
    first_from_camera: (4, 4), left camera of this frame in that of the first one, metres.
    world_from_camera: (4, 4); the simulator's world, x forward and y left at the start, z up.
    """

    index: int
    timestamp_ns: int
    k: NDArray[np.float64]
    world_from_camera: NDArray[np.float64]
    first_from_camera: NDArray[np.float64]
    objects: tuple[ObjectTruth, ...]
    files: tuple[WrittenFile, ...]


def write_frame_truth(path: Path, truth: FrameTruth) -> None:
    """Write it as JSON; every number comes back as it was."""
    write_json(
        path,
        {
            "index": truth.index,
            "timestamp_ns": truth.timestamp_ns,
            "k": truth.k.tolist(),
            "world_from_camera": truth.world_from_camera.tolist(),
            "first_from_camera": truth.first_from_camera.tolist(),
            "objects": [_object_row(item) for item in truth.objects],
            "files": [[file.name, file.size_bytes, file.sha256] for file in truth.files],
        },
    )


def read_frame_truth(path: Path) -> FrameTruth:
    """Read it back. Raises InputError for what is no such file."""
    row = read_json(path, "what is known of a finished frame")
    try:
        return FrameTruth(
            row["index"],
            row["timestamp_ns"],
            np.array(row["k"], np.float64).reshape(3, 3),
            np.array(row["world_from_camera"], np.float64).reshape(4, 4),
            np.array(row["first_from_camera"], np.float64).reshape(4, 4),
            tuple(_object(item) for item in row["objects"]),
            tuple(WrittenFile(*file) for file in row["files"]),
        )
    except (KeyError, TypeError, ValueError, IndexError) as error:
        raise InputError(f"{path}: not what is known of a finished frame ({error!r})") from None


def _object_row(item: ObjectTruth) -> dict[str, Any]:
    return {
        "id": item.object_id,
        "category": item.category,
        "moving": item.moving,
        "mask": item.mask.as_coco(),
        "box": None if item.box is None else asdict(item.box),
    }


def _object(row: dict[str, Any]) -> ObjectTruth:
    (height, width), counts = row["mask"]["size"], row["mask"]["counts"]
    box = None if row["box"] is None else _box(row["box"])
    return ObjectTruth(row["id"], row["category"], row["moving"], Rle(height, width, counts), box)


def _box(row: dict[str, Any]) -> TrackedBox:
    fields: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in row.items()}
    return TrackedBox(**fields)
