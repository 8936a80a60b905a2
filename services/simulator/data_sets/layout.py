# SPDX-License-Identifier: Apache-2.0
"""Where everything of a data set lies, by names relative to its folder."""

from __future__ import annotations

from dataclasses import dataclass

MANIFEST = "dataset.json"
CHECKSUMS = "SHA256SUMS"
README = "README.txt"
COCO = "annotations/instances.json"
PROGRESS = ".progress"
"""Folder of what is known of finished frames; gone when the data set is complete."""


def frame_name(index: int) -> str:
    """What every file of a frame is called, without suffix, as KITTI does."""
    return f"{index:06d}"


@dataclass(frozen=True, slots=True)
class SequencePaths:
    """The names of one sequence's files; `sequence` is such as `00`."""

    sequence: str

    def image(self, camera: int, index: int) -> str:
        """KITTI's cameras: 0 and 1 grey, 2 and 3 colour, even ones left."""
        return self._frame_file(f"image_{camera}", index)

    def depth(self, index: int) -> str:
        """Depth image of a frame."""
        return self._frame_file("depth", index)

    def instances(self, index: int) -> str:
        """Label image of a frame."""
        return self._frame_file("instances", index)

    def moving(self, index: int) -> str:
        """Mask of what moves in a frame."""
        return self._frame_file("moving", index)

    def flow(self, index: int) -> str:
        """Flow from a frame to the next one."""
        return self._frame_file("flow", index)

    @property
    def folder(self) -> str:
        """The folder of KITTI's odometry layout."""
        return f"sequences/{self.sequence}"

    @property
    def calibration(self) -> str:
        """KITTI's projection matrices."""
        return f"{self.folder}/calib.txt"

    @property
    def times(self) -> str:
        """Capture times."""
        return f"{self.folder}/times.txt"

    @property
    def trajectory(self) -> str:
        """The path as TUM writes it."""
        return f"{self.folder}/trajectory.tum"

    @property
    def instance_folder(self) -> str:
        """The folder that `kinemap run` finds beside the images."""
        return f"{self.folder}/instances"

    @property
    def poses(self) -> str:
        """The path as KITTI writes it."""
        return f"poses/{self.sequence}.txt"

    @property
    def tracking_labels(self) -> str:
        """KITTI's tracking labels."""
        return f"label_02/{self.sequence}.txt"

    @property
    def mots(self) -> str:
        """MOTS as text."""
        return f"instances_txt/{self.sequence}.txt"

    @property
    def surface(self) -> str:
        """What stands, as points."""
        return f"surface/{self.sequence}.ply"

    def frame_record(self, index: int) -> str:
        """What is known of a finished frame."""
        return f"{PROGRESS}/{self.sequence}/{frame_name(index)}.json"

    def frame_points(self, index: int) -> str:
        """The surface that one frame saw."""
        return f"{PROGRESS}/{self.sequence}/{frame_name(index)}.npy"

    def _frame_file(self, folder: str, index: int) -> str:
        return f"{self.folder}/{folder}/{frame_name(index)}.png"
