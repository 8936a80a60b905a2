# SPDX-License-Identifier: Apache-2.0
"""The files that speak of a whole sequence: written at the end, out of what is known of its frames."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from services.formats.kitti_poses import write_kitti_poses, write_times
from services.formats.kitti_tracking import write_kitti_tracking
from services.formats.label_images import INDEX_NAME, LabelledInstance, write_label_index
from services.formats.mots import CAR, IDS_PER_CLASS, IGNORED, PERSON, MotsObject, mots_id, write_mots_text
from services.formats.rle import Rle, decode_mask, encode_mask
from services.formats.trajectory import Trajectory
from services.formats.tum import write_tum
from services.simulator.data_sets.frame_truth import FrameTruth
from services.simulator.data_sets.layout import SequencePaths, frame_name
from services.simulator.data_sets.surface import thinned, write_ply
from services.simulator.data_sets.whole_file import WrittenFile, write_whole
from services.simulator.options import DriveOptions

_MOTS_CLASS = {"car": CAR, "person": PERSON}
_LASER_AXES = np.array([[0.0, -1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [1.0, 0.0, 0.0, 0.0]])
"""camera_from_laser with the laser at the camera: x forward, y left, z up. There is none, but readers ask for `Tr`."""


class SequenceFiles:
    """Writes one sequence's files below `root` from its frames, in their order."""

    def __init__(self, root: Path, sequence: str, options: DriveOptions, frames: Sequence[FrameTruth]) -> None:
        self._root, self._options, self._frames = root, options, frames
        self._paths = SequencePaths(sequence)

    def write(self, formats: frozenset[str]) -> Iterator[WrittenFile]:
        """Write what `formats` ask for. Raises ResourceError where the disk does not take it."""
        path_of_camera = self._trajectory()
        times = path_of_camera.timestamp_ns
        k, baseline_m = self._frames[0].k, self._options.stereo_baseline_m
        yield self._file(self._paths.calibration, lambda path: write_calibration(path, k, baseline_m))
        yield self._file(self._paths.times, lambda path: write_times(times, path))
        yield self._file(self._paths.poses, lambda path: write_kitti_poses(path_of_camera, path))
        if "tum" in formats:
            yield self._file(self._paths.trajectory, lambda path: write_tum(path_of_camera, path))
        if "instances" in formats:
            yield self._file(f"{self._paths.instance_folder}/{INDEX_NAME}", self._write_label_index)
        if "tracking" in formats:
            boxes = [item.box for frame in self._frames for item in frame.objects if item.box is not None]
            yield self._file(self._paths.tracking_labels, lambda path: write_kitti_tracking(path, boxes))
        if "mots" in formats:
            yield self._file(self._paths.mots, lambda path: write_mots_text(path, mots_objects(self._frames)))
        if "surface" in formats:
            yield self._file(self._paths.surface, self._write_surface)

    def _file(self, name: str, write: Callable[[Path], None]) -> WrittenFile:
        return write_whole(self._root, name, write)

    def _trajectory(self) -> Trajectory:
        times = np.array([frame.timestamp_ns for frame in self._frames], np.int64)
        return Trajectory(times, np.array([frame.first_from_camera for frame in self._frames]))

    def _write_label_index(self, path: Path) -> None:
        index = {
            frame_name(frame.index): [
                LabelledInstance(item.object_id, item.category, moving=item.moving) for item in frame.objects
            ]
            for frame in self._frames
        }
        # The index has a name of its own in every folder: written beside what is known of the frames, then moved.
        folder = (self._root / self._paths.frame_record(0)).parent
        write_label_index(folder, index)
        (folder / INDEX_NAME).replace(path)

    def _write_surface(self, path: Path) -> None:
        names = [self._root / self._paths.frame_points(frame.index) for frame in self._frames]
        clouds: list[NDArray[Any]] = [np.load(name, allow_pickle=False) for name in names if name.is_file()]
        write_ply(path, thinned(clouds), "frame: first left camera, x right, y down, z forward, metres")


def write_calibration(path: Path, k: NDArray[np.float64], baseline_m: float) -> None:
    """P0..P3 as KITTI's odometry benchmark has them: grey left, grey right, colour left, colour right.

    Each is [K | t], px, with t = -fx * baseline_m for the right ones; without stereo all four are the left camera's.
    """
    left = np.hstack([k, np.zeros((3, 1))])
    right = left.copy()
    right[0, 3] = -left[0, 0] * baseline_m
    rows = {"P0": left, "P1": right, "P2": left, "P3": right, "Tr": _LASER_AXES}
    # Adding 0 turns -0 into 0.
    lines = [f"{name}: {' '.join(f'{value + 0.0:.12e}' for value in row.ravel())}\n" for name, row in rows.items()]
    path.write_text("".join(lines), encoding="ascii")


def mots_objects(frames: Sequence[FrameTruth]) -> Iterator[MotsObject]:
    """Cars and people, numbered within their class in the order of their ids; all else is one ignored region a frame.

    Raises:
        InputError: more objects of a class than MOTS has ids for.
    """
    number = {
        object_id: mots_id(class_id, place)
        for category, class_id in _MOTS_CLASS.items()
        for place, object_id in enumerate(
            sorted({item.object_id for frame in frames for item in frame.objects if item.category == category})
        )
    }
    for frame in frames:
        ignored: list[Rle] = []
        for item in frame.objects:
            if item.object_id in number:
                yield MotsObject(frame.index, number[item.object_id], _MOTS_CLASS[item.category], item.mask)
            else:
                ignored.append(item.mask)
        if ignored:
            mask = encode_mask(np.any([decode_mask(rle) for rle in ignored], axis=0))
            yield MotsObject(frame.index, IGNORED * IDS_PER_CLASS, IGNORED, mask)
