# SPDX-License-Identifier: Apache-2.0
"""One frame's files of a data set."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from services.formats.kitti_flow import FlowImage, write_kitti_flow
from services.formats.label_images import write_label_image
from services.formats.png import write_png
from services.formats.rle import encode_mask
from services.runtime.errors import InputError
from services.simulator.data_sets.frame_truth import FrameTruth, ObjectTruth, read_frame_truth, write_frame_truth
from services.simulator.data_sets.layout import SequencePaths
from services.simulator.data_sets.surface import EVERY_FRAMES, frame_surface
from services.simulator.data_sets.tracking_labels import TrackingLabels
from services.simulator.data_sets.whole_file import WrittenFile, write_whole
from services.simulator.drive import Drive
from services.simulator.frame import SimulatedFrame

DEPTH_PER_M = 256.0
"""KITTI's depth images count in 1/256 m; 0 is sky, or farther than 16 bits reach."""
NOBODY, NON_MOVING, MOVING = 0, 1, 2
"""Values of the moving masks."""


class FrameWriter:
    """Writes frames of one drive into a data set at `root`.

    Args:
        root: the data set's folder.
        sequence: the drive's name in it.
        drive: what is rendered.
        formats: names out of `request.FORMATS`.
    """

    def __init__(self, root: Path, sequence: str, drive: Drive, formats: frozenset[str]) -> None:
        self._root, self._drive, self._formats = root, drive, formats
        self._paths = SequencePaths(sequence)
        self._labels = TrackingLabels(drive)
        self._first_from_world: NDArray[np.float64] = np.linalg.inv(drive.world_from_camera(0)).astype(np.float64)

    def write(self, index: int) -> None:
        """Render and write one frame; what is known of it comes last and says that the rest is there.

        Raises:
            ResourceError: the disk does not take it.
        """
        frame = self._drive.render(index)
        files = [*self._images(frame), *self._truth_images(frame)]
        if "surface" in self._formats and _shows_surface(index):
            points = frame_surface(frame, self._drive.camera.k, self._first_from_world)
            write_whole(self._root, self._paths.frame_points(index), partial(_save_points, points))
        pose = frame.world_from_camera
        truth = FrameTruth(
            index,
            frame.timestamp_ns,
            self._drive.camera.k,
            pose,
            self._first_from_world @ pose,
            self._objects(frame),
            tuple(files),
        )
        write_whole(self._root, self._paths.frame_record(index), partial(_save_truth, truth))

    def _images(self, frame: SimulatedFrame) -> list[WrittenFile]:
        files = []
        for side, image in enumerate((frame.image, frame.image_right)):
            if image is None:
                continue
            files.append(self._png(self._paths.image(2 + side, frame.index), image[..., ::-1]))
            if "grey" in self._formats:
                grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY)
                files.append(self._png(self._paths.image(side, frame.index), grey))
        return files

    def _truth_images(self, frame: SimulatedFrame) -> list[WrittenFile]:
        files = []
        index = frame.index
        if "depth" in self._formats:
            files.append(self._png(self._paths.depth(index), depth_levels(frame.depth_m)))
        if "instances" in self._formats:
            name = self._paths.instances(index)
            files.append(write_whole(self._root, name, lambda path: write_label_image(path, frame.labels)))
        if "moving" in self._formats:
            files.append(self._png(self._paths.moving(index), moving_mask(frame)))
        if "flow" in self._formats and index + 1 < self._drive.frame_count:
            truth = self._drive.flow(index)
            flow = FlowImage(truth.flow_px, truth.visible)
            name = self._paths.flow(index)
            files.append(write_whole(self._root, name, lambda path: write_kitti_flow(path, flow)))
        return files

    def _objects(self, frame: SimulatedFrame) -> tuple[ObjectTruth, ...]:
        boxes = self._labels.boxes(frame) if "tracking" in self._formats else {}
        return tuple(
            ObjectTruth(
                item.instance_id,
                item.category,
                item.moving,
                encode_mask(frame.labels == item.instance_id),
                boxes.get(item.instance_id),
            )
            for item in frame.instances
        )

    def _png(self, name: str, pixels: NDArray[Any]) -> WrittenFile:
        return write_whole(self._root, name, lambda path: write_png(path, pixels))


def finished_frame(root: Path, sequence: str, index: int, formats: frozenset[str]) -> FrameTruth | None:
    """What is known of a frame that is there whole; None for one that has to be rendered."""
    paths = SequencePaths(sequence)
    record = root / paths.frame_record(index)
    if not record.is_file():
        return None
    try:
        truth = read_frame_truth(record)
        whole = all((root / file.name).stat().st_size == file.size_bytes for file in truth.files)
    except (InputError, OSError):
        return None
    if "surface" in formats and _shows_surface(index):
        whole = whole and (root / paths.frame_points(index)).is_file()
    return truth if whole else None


def depth_levels(depth_m: NDArray[np.float32]) -> NDArray[np.uint16]:
    """Depth (H, W) as KITTI stores it, to the nearest 1/256 m."""
    levels = np.rint(depth_m.astype(np.float64) * DEPTH_PER_M)
    return np.where(levels > np.iinfo(np.uint16).max, 0, levels).astype(np.uint16)


def moving_mask(frame: SimulatedFrame) -> NDArray[np.uint8]:
    """Mask (H, W) of what could move: NON_MOVING where it stands, MOVING where it moves, else NOBODY."""
    moving = [item.instance_id for item in frame.instances if item.moving]
    mask = np.where(frame.labels > 0, NON_MOVING, NOBODY).astype(np.uint8)
    mask[np.isin(frame.labels, moving)] = MOVING
    return mask


def _shows_surface(index: int) -> bool:
    return index % EVERY_FRAMES == 0


def _save_points(points: NDArray[np.void], path: Path) -> None:
    with path.open("wb") as file:
        np.save(file, points, allow_pickle=False)


def _save_truth(truth: FrameTruth, path: Path) -> None:
    write_frame_truth(path, truth)
