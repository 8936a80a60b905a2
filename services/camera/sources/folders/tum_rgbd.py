# SPDX-License-Identifier: Apache-2.0
"""A sequence of the TUM RGB-D benchmark, or a folder laid out like one.

Source: Sturm et al., "A benchmark for the evaluation of RGB-D SLAM systems", IROS 2012, and the benchmark's pages on
file formats and on the cameras' calibration.
"""

from pathlib import Path
from types import MappingProxyType
from typing import Final

from services.camera.sources.association import FARTHEST_NS, nearest_pairs
from services.camera.sources.calibration_file import CameraModel, find_calibration, read_calibration
from services.camera.sources.folders.depth_files import DepthFiles
from services.camera.sources.folders.image_files import ListedImages
from services.camera.sources.folders.number_rows import ASSUMED_RATE_HZ, parse_time_ns, rate_of, read_lines
from services.camera.sources.indexed_source import CameraImages, IndexedSource
from services.camera.sources.true_path import note_of_missing, poses_at
from services.formats.tum import read_tum
from services.runtime.errors import InputError

_LISTING = "rgb.txt"
LEVELS_PER_METRE = 5000.0
CALIBRATION_NAME = "calibration.toml"
# fx, fy, cx, cy, then k1, k2, p1, p2, k3 of each Kinect's colour camera, as the benchmark publishes them.
_CAMERAS: Final = MappingProxyType({
    "freiburg1": ((517.3, 516.5, 318.6, 255.3), (0.2624, -0.9531, -0.0054, 0.0026, 1.1633)),
    "freiburg2": ((520.9, 521.0, 325.1, 249.7), (0.2312, -0.7849, -0.0033, -0.0001, 0.9172)),
    "freiburg3": ((535.4, 539.2, 320.1, 247.6), ()),
})  # fmt: skip
_CAMERA_SIZE = (640, 480)

TimedFile = tuple[int, Path]


def is_tum_folder(folder: Path) -> bool:
    """Whether there is a list of colour images."""
    return (folder / _LISTING).is_file()


class TumRgbd(IndexedSource):
    """rgb.txt with its images, depth.txt with depth images registered to them, groundtruth.txt.

    A colour image without a depth image within 0.02 s is left out where there is a depth.txt. True poses are those of
    the colour camera's optical frame in the motion capture's world, interpolated to each image's time.

    Args:
        folder: the sequence's folder; freiburg1, freiburg2 or freiburg3 in its name tells the camera.
        calibration: the calibration file; None looks for calibration.toml in the folder, then at the folder's name.
        depth: give depth too, where there is a depth.txt.

    Raises:
        InputError: whatever of the folder cannot be used, by file and line.
    """

    def __init__(self, folder: Path, *, calibration: Path | None = None, depth: bool = True) -> None:
        colours = _read_listing(folder / _LISTING)
        notes: list[str] = []
        depth_paths: list[Path] | None = None
        if depth and (folder / "depth.txt").is_file():
            found = len(colours)
            colours, depth_paths = _associated(folder, colours, _read_listing(folder / "depth.txt"))
            if len(colours) < found:
                left_out = found - len(colours)
                notes.append(f"{left_out} of {found} colour images have no depth image within 0.02 s and are left out")
        times_ns = [time_ns for time_ns, _ in colours]
        images = ListedImages([path for _, path in colours])
        camera = _camera_of(folder, calibration, images, notes)
        poses = None
        if (folder / "groundtruth.txt").is_file():
            poses = poses_at(read_tum(folder / "groundtruth.txt"), times_ns)
            notes += note_of_missing(poses)
        super().__init__(
            f"TUM RGB-D {folder.resolve().name}",
            times_ns,
            rate_of(times_ns, ASSUMED_RATE_HZ),
            CameraImages(images, camera.for_images(images.size, images.paths[0]).record(0)),
            depths=None if depth_paths is None else DepthFiles(depth_paths, images.size, LEVELS_PER_METRE),
            world_from_camera=poses,
            notes=notes,
        )


def _read_listing(path: Path) -> list[TimedFile]:
    rows: list[TimedFile] = []
    for line_number, line in read_lines(path):
        time, *names = line.split(maxsplit=1)
        if not names:
            raise InputError(f"{path} line {line_number}: {line!r}, expected a time in seconds and a file's name")
        time_ns = parse_time_ns(path, line_number, time, rows[-1][0] if rows else -1)
        rows.append((time_ns, path.parent / names[0]))
    if not rows:
        raise InputError(f"{path}: no images listed, expected lines of a time in seconds and a file's name")
    return rows


def _associated(folder: Path, colours: list[TimedFile], depths: list[TimedFile]) -> tuple[list[TimedFile], list[Path]]:
    pairs = nearest_pairs([time_ns for time_ns, _ in colours], [time_ns for time_ns, _ in depths], FARTHEST_NS)
    if not pairs:
        raise InputError(
            f"{folder}: no image of rgb.txt (from {colours[0][0] / 1e9:.3f} s) has one of depth.txt "
            f"(from {depths[0][0] / 1e9:.3f} s) within 0.02 s, expected times of one clock"
        )
    return [colours[index] for index, _ in pairs], [depths[other][1] for _, other in pairs]


def _camera_of(folder: Path, calibration: Path | None, images: ListedImages, notes: list[str]) -> CameraModel:
    own = folder / CALIBRATION_NAME
    name = folder.resolve().name
    known = next((key for key in _CAMERAS if key in name), None)
    if calibration is not None or own.is_file() or known is None:
        return read_calibration(find_calibration(calibration, own))
    (fx, fy, cx, cy), distortion = _CAMERAS[known]
    if images.size != _CAMERA_SIZE:
        raise InputError(
            f"image {images.paths[0]}: {images.size[0]}x{images.size[1]} px, expected 640x480 as of {known}'s camera, "
            f"or a {CALIBRATION_NAME}"
        )
    notes.append(f"no {CALIBRATION_NAME}: the camera of {known} is assumed by the folder's name (fx {fx:g} px)")
    return CameraModel(own, fx, fy, cx, cy, _CAMERA_SIZE, distortion)
