# SPDX-License-Identifier: Apache-2.0
"""A map.sqlite as files that other tools read."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Final

import numpy as np

from services.mapstore import map_file
from services.mapstore.dense_table import read_clouds
from services.mapstore.export.dense_pcd import dense_pcd, dense_points_of
from services.mapstore.export.kitti import trajectory_kitti
from services.mapstore.export.pcd import map_pcd
from services.mapstore.export.tum import keyframes_tum, trajectory_tum
from services.mapstore.map_view import MapView
from services.mapstore.store import read_map
from services.runtime.errors import InputError, ResourceError

_Write = Callable[[MapView, int], bytes]
_FILES: Final[dict[str, dict[str, _Write]]] = {
    "tum": {
        "trajectory.tum": lambda view, map_id: trajectory_tum(view, map_id).encode("ascii"),
        "keyframes.tum": lambda view, map_id: keyframes_tum(view, map_id).encode("ascii"),
    },
    "kitti": {"trajectory.kitti": lambda view, map_id: trajectory_kitti(view, map_id).encode("ascii")},
    "pcd": {"map.pcd": map_pcd},
}
FORMATS: Final = tuple(_FILES)


def export_map(
    database: Path, out: Path, formats: Iterable[str] = ("tum", "pcd"), map_id: int | None = None
) -> list[Path]:
    """Writes `database` into the folder `out` and returns the files.

    They are trajectory.tum and keyframes.tum (format tum), trajectory.kitti (kitti), map.pcd (pcd) and, of a map that
    has semi-dense points, map_dense.pcd (pcd).

    Maps that were never joined share no frame of reference, so one map is written: `map_id`, or the one with the most
    frames. Raises InputError for a format or a file that is not known, ResourceError when `out` cannot be written.
    """
    formats = tuple(formats)
    for name in formats:
        if name not in _FILES:
            raise InputError(f"format '{name}': expected one of {', '.join(FORMATS)}")
    view = load_view(database)
    chosen = main_map_id(view) if map_id is None else map_id
    written = []
    for name in formats:
        for file, content in _FILES[name].items():
            _write(out / file, content(view, chosen))
            written.append(out / file)
    if "pcd" in formats and view.dense_points > 0:
        _write(out / "map_dense.pcd", _dense(database, view, chosen))
        written.append(out / "map_dense.pcd")
    return written


def load_view(database: Path) -> MapView:
    """The map of a map.sqlite, also while a service writes it. Raises InputError when it is none."""
    connection = map_file.open_to_read(database)
    try:
        return read_map(connection).view()
    finally:
        connection.close()


def _dense(database: Path, view: MapView, map_id: int) -> bytes:
    connection = map_file.open_to_read(database)
    try:
        return dense_pcd(dense_points_of(view, read_clouds(connection), map_id), view.metric_scale)
    finally:
        connection.close()


def main_map_id(view: MapView) -> int:
    """The map that most frames with a pose are in; the lower id of two."""
    posed = np.isfinite(view.frames.live_pose[:, 0]) | (view.frames.reference_row >= 0)
    if not posed.any():
        return view.map_id
    ids, frames = np.unique(view.frame_map_ids()[posed], return_counts=True)
    return int(ids[np.argmax(frames)])


def _write(path: Path, content: bytes) -> None:
    """Whole or not at all."""
    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(content)
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise ResourceError(f"{path}: cannot be written ({error.strerror})") from error
