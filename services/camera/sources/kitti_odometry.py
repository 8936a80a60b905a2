# SPDX-License-Identifier: Apache-2.0
"""A sequence of the KITTI odometry benchmark, or a folder laid out like one."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from schemas.records import CameraCalibration, Image, TruePose
from services.camera.sources.image_files import ImageFiles
from services.camera.sources.kitti_calibration import camera_0_from, read_projections
from services.camera.sources.number_rows import even_times_ns, rate_of, read_kitti_poses, read_times_ns
from services.camera.sources.source import SourceFrame
from services.runtime.errors import InputError

ASSUMED_RATE_HZ = 10.0
# Colour first: the networks behind the camera were trained on it.
LEFT_FOLDERS = ("image_2", "image_0")
_RIGHT_OF = {"image_0": "image_1", "image_2": "image_3"}


def is_kitti_folder(folder: Path) -> bool:
    """Whether there is a left camera's image folder, image_0 or image_2."""
    return any((folder / name).is_dir() for name in LEFT_FOLDERS)


class KittiOdometry:
    """image_0 or image_2 (left), image_1 or image_3 (right), calib.txt, times.txt and poses as far as they are there.

    Poses are looked for as poses.txt in the folder and as ../../poses/<folder's name>.txt; their world is the first
    pose of camera 0 (x right, y down, z forward), and they are given for the camera whose images are used.

    Args:
        folder: the sequence's folder, e.g. sequences/03.
        left: "image_0" or "image_2"; None takes the colour images where there are some.
        stereo: give the right image too where there is one.
        rate_hz: rate to assume without times.txt.

    Raises:
        InputError: whatever of the folder cannot be used, by file and line.
    """

    def __init__(
        self, folder: Path, *, left: str | None = None, stereo: bool = True, rate_hz: float = ASSUMED_RATE_HZ
    ) -> None:
        if left is None:
            left = next((name for name in LEFT_FOLDERS if (folder / name).is_dir()), LEFT_FOLDERS[-1])
        notes: list[str] = []
        self._images = ImageFiles(folder / left)
        right = folder / _RIGHT_OF[left]
        self._images_right = ImageFiles(right) if stereo and right.is_dir() else None
        projections = read_projections(folder / "calib.txt")
        self._calibrate(folder / "calib.txt", projections, left, notes)
        if (folder / "times.txt").is_file():
            self._times_ns = read_times_ns(folder / "times.txt", len(self._images))
            self._rate_hz = rate_of(self._times_ns, rate_hz)
        else:
            notes.append(f"no times.txt in {folder.name}: times are assumed at {rate_hz:g} Hz")
            self._times_ns = even_times_ns(len(self._images), rate_hz)
            self._rate_hz = rate_hz
        self._world_from_camera = self._read_poses(folder)
        self._name = f"KITTI {folder.resolve().name}, {left}"
        self._notes = tuple(notes)

    @property
    def name(self) -> str:
        return self._name

    @property
    def frame_count(self) -> int:
        return len(self._images)

    @property
    def rate_hz(self) -> float:
        return self._rate_hz

    @property
    def notes(self) -> tuple[str, ...]:
        return self._notes

    def frame(self, index: int) -> SourceFrame | None:
        if index >= len(self._images):
            return None
        time_ns = self._times_ns[index]
        right = self._images_right
        poses = self._world_from_camera
        return SourceFrame(
            self._images.name(index),
            time_ns,
            Image(time_ns, self._images.read(index)),
            self._record(time_ns, self._intrinsics, "camera"),
            image_right=None if right is None else Image(time_ns, right.read(index), "camera_right"),
            calibration_right=None if right is None else self._record(time_ns, self._projection_right, "camera_right"),
            true_pose=None if poses is None else TruePose(time_ns, poses[index]),
        )

    def close(self) -> None:
        """Nothing is held open."""

    def _calibrate(
        self, path: Path, projections: dict[str, npt.NDArray[np.float64]], left: str, notes: list[str]
    ) -> None:
        """Choose the projections of the images in use; the left camera is where the pair's own frame is."""
        left_projection = projections.get(f"P{left[-1]}")
        if left_projection is None:
            if self._images_right is not None:
                raise InputError(f"{path}: no line 'P{left[-1]}:', expected one for the stereo images in {left}")
            found, left_projection = next(iter(projections.items()))
            notes.append(f"calib.txt has no P{left[-1]}: {found} is taken for the images in {left}")
        self._intrinsics = np.hstack((left_projection[:, :3], np.zeros((3, 1))))
        self._camera_0_from_camera = camera_0_from(left_projection)
        if self._images_right is None:
            return
        right = _RIGHT_OF[left]
        if len(self._images_right) != len(self._images):
            raise InputError(f"{path.parent / right}: {len(self._images_right)} images, expected {len(self._images)}")
        if self._images_right.size != self._images.size:
            raise InputError(
                f"{path.parent / right}: images of {'x'.join(map(str, self._images_right.size))} px, "
                f"expected {'x'.join(map(str, self._images.size))} as in {left}"
            )
        if f"P{right[-1]}" not in projections:
            raise InputError(f"{path}: no line 'P{right[-1]}:', expected one for the stereo images in {right}")
        self._projection_right = projections[f"P{right[-1]}"].copy()
        self._projection_right[:, 3] -= left_projection[:, 3]

    def _read_poses(self, folder: Path) -> npt.NDArray[np.float64] | None:
        for path in (folder / "poses.txt", folder.resolve().parent.parent / "poses" / f"{folder.resolve().name}.txt"):
            if path.is_file():
                return read_kitti_poses(path, len(self._images)) @ self._camera_0_from_camera
        return None

    def _record(self, time_ns: int, projection: npt.NDArray[np.float64], frame_id: str) -> CameraCalibration:
        width, height = self._images.size
        return CameraCalibration(
            time_ns, width, height, projection[:, :3].copy(), projection=projection.copy(), frame_id=frame_id
        )
