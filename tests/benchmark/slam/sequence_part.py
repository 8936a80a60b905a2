# SPDX-License-Identifier: Apache-2.0
"""Which frames of which recording the engine is given, and where the camera truly was."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from tests.benchmark.slam.frame_objects import FrameObjects, ObjectSource, no_objects
from tests.benchmark.slam.mask_objects import MaskObjects
from tests.benchmark.slam.true_objects import TrueObjects

Array = npt.NDArray[np.float64]


class SequenceFrame(NamedTuple):
    """What the camera and the masks give of one moment."""

    image: npt.NDArray[np.uint8]
    objects: FrameObjects
    right: npt.NDArray[np.uint8] | None = None


@dataclass(frozen=True)
class SequencePart:
    """Frames start, start + step, ... of a folder in KITTI's odometry layout (`.../sequences/NAME`).

    A negative step goes backward; `black` replaces the images by black ones. Masks are read from `instances/`, true
    ones with their motion where `kinemap simulate` made the folder.
    """

    folder: Path
    start: int = 0
    frames: int | None = None
    step: int = 1
    images: str = "image_0"
    black: bool = False
    right_images: str | None = None
    """the other images of a rectified pair, such as image_1; none: one camera"""

    def paths(self) -> list[Path]:
        """The images, in the order in which they are shown. FileNotFoundError where there are none."""
        there = sorted((self.folder / self.images).glob("*.png"))
        if not there:
            raise FileNotFoundError(f"{self.folder / self.images}: no images")
        return there[self.start :: self.step][: self.frames]

    def intrinsics(self) -> tuple[float, float, float, float]:
        """fx, fy, cx, cy in pixels, of P0."""
        p = self._projection("P0")
        return float(p[0, 0]), float(p[1, 1]), float(p[0, 2]), float(p[1, 2])

    def baseline_m(self) -> float:
        """Of the pair; 0 where one camera is used."""
        if self.right_images is None:
            return 0.0
        p = self._projection("P1")
        return float(-p[0, 3] / p[0, 0])

    def read(self) -> Iterator[SequenceFrame]:
        """The frames, one by one."""
        objects = self._objects()
        for path in self.paths():
            image = _grey(path)
            right = None if self.right_images is None else _grey(self.folder / self.right_images / path.name)
            if self.black:
                dark = np.zeros_like(image)
                yield SequenceFrame(dark, no_objects(*image.shape), None if right is None else dark)
            else:
                yield SequenceFrame(image, objects.at(path.stem) if objects else no_objects(*image.shape), right)

    def true_poses(self) -> Array:
        """world_from_camera of the frames (N, 4, 4); the world is the first frame's camera, or the simulator's."""
        file = self._root / "poses" / f"{self.folder.name}.txt"
        poses = np.tile(np.eye(4), (len(file.read_text().splitlines()), 1, 1))
        poses[:, :3] = np.loadtxt(file).reshape(-1, 3, 4)
        description = self._description()
        if description is not None:
            poses = np.array(description["sequences"][self.folder.name]["world_from_first_camera"]) @ poses
        return poses[self.start :: self.step][: self.frames]

    def _projection(self, name: str) -> Array:
        lines = (self.folder / "calib.txt").read_text().splitlines()
        return np.array(next(line for line in lines if line.startswith(name)).split()[1:], float).reshape(3, 4)

    @property
    def _root(self) -> Path:
        return self.folder.resolve().parent.parent

    def _description(self) -> dict[str, dict[str, dict[str, list[list[float]]]]] | None:
        """What `kinemap simulate` says about its folder; None for a real recording."""
        file = self._root / "dataset.json"
        return dict(json.loads(file.read_text())) if file.is_file() else None

    def _objects(self) -> ObjectSource | None:
        folder = self.folder / "instances"
        if not (folder / "instances.json").is_file():
            return None
        return MaskObjects(folder) if self._description() is None else TrueObjects(folder)


def _grey(path: Path) -> npt.NDArray[np.uint8]:
    return np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), np.uint8)
