# SPDX-License-Identifier: Apache-2.0
"""Which source an input is."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from services.camera.sources.first_frames import FirstFrames
from services.camera.sources.image_files import list_images
from services.camera.sources.image_folder import ImageFolder
from services.camera.sources.kitti_odometry import KittiOdometry, is_kitti_folder
from services.camera.sources.simulator import Simulator
from services.camera.sources.source import Source
from services.camera.sources.video_file import VIDEO_SUFFIXES, VideoFile
from services.runtime.errors import InputError
from services.simulator.options import DriveOptions

SIMULATOR = "simulator"
SESSION_SUFFIX = ".mcap"
_EXPECTED = (
    "expected a KITTI odometry folder (image_0 or image_2, calib.txt), a folder of PNG or JPEG images with "
    f"calibration.toml, a video ({', '.join(VIDEO_SUFFIXES)}), a recorded session ({SESSION_SUFFIX}) or '{SIMULATOR}'"
)


@dataclass(frozen=True)
class SourceOptions:
    """What a user can say about an input beyond its path; see `CameraConfig`."""

    calibration: Path | None = None
    kitti_images: Literal["auto", "image_0", "image_2"] = "auto"
    stereo: bool = True
    rate_hz: float | None = None
    max_frames: int | None = None


def open_source(given: str, options: SourceOptions, street: DriveOptions) -> Source:
    """The source that `given` is: 'simulator', or the path of a folder or a file; checked, nothing decoded yet.

    Raises:
        InputError: the path is none of the known inputs, or its contents cannot be used.
    """
    source = _open_whole(given, options, street)
    return source if options.max_frames is None else FirstFrames(source, options.max_frames)


def _open_whole(given: str, options: SourceOptions, street: DriveOptions) -> Source:
    if given == SIMULATOR:
        return Simulator(street)
    path = Path(given)
    if path.is_dir():
        return _open_folder(path, options)
    if not path.exists():
        raise InputError(f"input {given}: no such file or folder; {_EXPECTED}")
    if path.suffix.lower() in VIDEO_SUFFIXES:
        return VideoFile(path, calibration=options.calibration)
    if path.suffix.lower() == SESSION_SUFFIX:
        # Reading sessions needs libraries that no other input does.
        from services.camera.sources.mcap_session import McapSession

        return McapSession(path)
    raise InputError(f"input {given}: not an input that is known; {_EXPECTED}")


def _open_folder(path: Path, options: SourceOptions) -> Source:
    try:
        if is_kitti_folder(path):
            return KittiOdometry(
                path,
                left=None if options.kitti_images == "auto" else options.kitti_images,
                stereo=options.stereo,
                rate_hz=options.rate_hz,
            )
        if (path / "images").is_dir() or list_images(path):
            return ImageFolder(path, calibration=options.calibration, rate_hz=options.rate_hz)
        what = "no images in this folder" if any(path.iterdir()) else "the folder is empty"
    except OSError as error:
        raise InputError(f"input {path}: cannot be read ({error.strerror})") from error
    raise InputError(f"input {path}: {what}; {_EXPECTED}")
