# SPDX-License-Identifier: Apache-2.0
"""A folder that becomes a data set: begun, gone on with, completed, never overwritten."""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from services.formats.coco import write_coco
from services.runtime.errors import InputError, ResourceError
from services.simulator.data_sets.coco_file import coco_dataset
from services.simulator.data_sets.frame_truth import FrameTruth
from services.simulator.data_sets.frame_writer import finished_frame
from services.simulator.data_sets.layout import COCO, MANIFEST, PROGRESS, README
from services.simulator.data_sets.manifest import (
    Manifest,
    missing_files,
    options_of,
    read_manifest,
    require_same_options,
    write_checksums,
    write_manifest,
)
from services.simulator.data_sets.readme_text import readme_text
from services.simulator.data_sets.request import DataSetRequest
from services.simulator.data_sets.sequence_files import SequenceFiles
from services.simulator.data_sets.whole_file import PART_SUFFIX, disk_errors, remove_parts, write_whole


class DataSet:
    """The data set that `request` asks for, in the folder `root`.

    Raises:
        InputError: the folder holds something else, or a data set of other options; names the first that differs.
        ResourceError: the folder cannot be made.
    """

    def __init__(self, root: Path, request: DataSetRequest) -> None:
        self.root, self.request = root, request
        self.complete = False
        if root.exists() and not root.is_dir():
            raise InputError(f"{root}: a file, expected a folder that is new, empty or to be gone on with")
        if (root / MANIFEST).is_file():
            manifest = read_manifest(root)
            require_same_options(root, manifest, request)
            self.complete = manifest.complete
            if self.complete and (missing := missing_files(root)):
                raise InputError(f"{root}: {missing[0]} is missing from the complete data set; expected another --out")
        elif root.is_dir():
            found = sorted(path.name for path in root.iterdir() if not path.name.endswith(PART_SUFFIX))
            if found:
                raise InputError(f"{root}: holds {found[0]} and no {MANIFEST}, expected a new or empty folder")

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Make the folder, and keep every other process from writing it. Raises ResourceError if one does already."""
        with disk_errors(self.root):
            self.root.mkdir(parents=True, exist_ok=True)
            folder = os.open(self.root, os.O_RDONLY)
        try:
            try:
                fcntl.flock(folder, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                raise ResourceError(f"{self.root}: another kinemap simulate is writing there") from None
            yield
        finally:
            os.close(folder)

    def frames_left(self) -> dict[str, list[int]]:
        """Begin or go on: the frames of every sequence that have to be rendered. Only while `locked`."""
        if self.complete:
            shutil.rmtree(self.root / PROGRESS, ignore_errors=True)  # a kill may have come just before this
        else:
            remove_parts(self.root)
            write_manifest(self.root, Manifest(options_of(self.request)))
        frames = () if self.complete else range(self.request.drive.frames)
        formats = self.request.formats
        return {
            sequence: [index for index in frames if finished_frame(self.root, sequence, index, formats) is None]
            for sequence in self.request.sequences
        }

    def finish(self) -> None:
        """Write what speaks of whole sequences, the checksums, and that the data set is complete.

        Raises:
            ResourceError: the disk does not take it, or a frame is not there.
        """
        request, formats = self.request, self.request.formats
        files = []
        frames = {sequence: self._frames(sequence) for sequence in request.sequences}
        for sequence, truths in frames.items():
            files += [file for truth in truths for file in truth.files]
            files += SequenceFiles(self.root, sequence, request.drive_of(sequence), truths).write(formats)
        if "coco" in formats:
            dataset = coco_dataset(request.drive, frames)
            files.append(write_whole(self.root, COCO, lambda path: write_coco(path, dataset)))
        text = readme_text(request)
        files.append(write_whole(self.root, README, lambda path: path.write_text(text, encoding="utf-8")))
        sums = write_checksums(self.root, files)
        about = {sequence: self._about(sequence, truths) for sequence, truths in frames.items()}
        write_manifest(self.root, Manifest(options_of(request), True, about, sums))
        self.complete = True
        shutil.rmtree(self.root / PROGRESS, ignore_errors=True)

    def _frames(self, sequence: str) -> list[FrameTruth]:
        truths = []
        for index in range(self.request.drive.frames):
            truth = finished_frame(self.root, sequence, index, self.request.formats)
            if truth is None:
                raise ResourceError(f"{self.root}: frame {index} of sequence {sequence} was removed meanwhile")
            truths.append(truth)
        return truths

    def _about(self, sequence: str, frames: list[FrameTruth]) -> dict[str, Any]:
        return {
            "seed": self.request.drive_of(sequence).seed,
            "frames": len(frames),
            "world_from_first_camera": frames[0].world_from_camera.tolist(),
        }
