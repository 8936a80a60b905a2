# SPDX-License-Identifier: Apache-2.0
"""Which source an input is."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from services.camera.sources.first_frames import FirstFrames
from services.camera.sources.folders.euroc import Euroc, is_euroc_folder
from services.camera.sources.folders.image_files import list_images
from services.camera.sources.folders.image_folder import ImageFolder
from services.camera.sources.folders.tum_rgbd import TumRgbd, is_tum_folder
from services.camera.sources.kitti.odometry import KittiOdometry, is_kitti_folder
from services.camera.sources.kitti.raw import KittiRaw, drives_in, is_kitti_drive
from services.camera.sources.kitti.tracking import KittiTracking, is_tracking_sequence, sequences_in
from services.camera.sources.live.live_address import is_live
from services.camera.sources.recordings.message_topics import TopicOptions
from services.camera.sources.simulator import Simulator
from services.camera.sources.source import Source
from services.camera.sources.video_file import VIDEO_SUFFIXES, VideoFile
from services.runtime.errors import InputError
from services.simulator.options import DriveOptions

SIMULATOR = "simulator"
SESSION_SUFFIX = ".mcap"
_BAG_SUFFIXES = (".bag", ".db3")
_BAG_LISTING = "metadata.yaml"
_EXPECTED = (
    "expected a KITTI odometry folder (image_0 or image_2, calib.txt), a KITTI raw drive (image_00/data), a KITTI "
    "tracking sequence (training/image_02/0000), a TUM RGB-D folder (rgb.txt), an EuRoC folder (mav0), a folder of PNG "
    f"or JPEG images with calibration.toml, a video ({', '.join(VIDEO_SUFFIXES)}), a ROS 1 bag (.bag), a ROS 2 bag (a "
    f"folder with {_BAG_LISTING}, .db3), MCAP ({SESSION_SUFFIX}: a recorded session, ROS 2 or Foxglove images), a "
    f"camera (0, /dev/video0, rtsp://, http://) or '{SIMULATOR}'"
)


@dataclass(frozen=True)
class SourceOptions:
    """What a user can say about an input beyond its path; see `CameraConfig`."""

    calibration: Path | None = None
    kitti_images: Literal["auto", "image_0", "image_2"] = "auto"
    stereo: bool = True
    rectify: bool = True
    depth: bool = True
    topic: str | None = None
    depth_topic: str | None = None
    info_topic: str | None = None
    truth_topic: str | None = None
    rate_hz: float | None = None
    max_frames: int | None = None

    @property
    def kitti_left(self) -> str | None:
        """The left images of a KITTI folder, None for the colour ones where there are some."""
        return None if self.kitti_images == "auto" else self.kitti_images

    @property
    def topics(self) -> TopicOptions:
        """What a bag's topics were said to be."""
        return TopicOptions(self.topic, self.depth_topic, self.info_topic, self.truth_topic, self.depth)


def open_source(given: str, options: SourceOptions, street: DriveOptions) -> Source:
    """The source that `given` is: 'simulator', a camera's address, or the path of a folder or a file; checked, nothing
    decoded yet.

    Raises:
        InputError: the path is none of the known inputs, or its contents cannot be used.
    """
    source = _open_whole(given, options, street)
    return source if options.max_frames is None else FirstFrames(source, options.max_frames)


def _open_whole(given: str, options: SourceOptions, street: DriveOptions) -> Source:
    if given == SIMULATOR:
        return Simulator(street)
    if is_live(given):
        from services.camera.sources.live.opencv_camera import open_live_camera

        return open_live_camera(given, calibration=options.calibration)
    path = Path(given)
    try:
        if path.is_dir():
            return _open_folder(path, options)
        if not path.exists():
            raise InputError(f"input {given}: no such file or folder; {_EXPECTED}")
        return _open_file(path, options)
    except OSError as error:
        raise InputError(f"input {given}: cannot be read ({error.strerror})") from error


def _open_file(path: Path, options: SourceOptions) -> Source:
    suffix = path.suffix.lower()
    if suffix in VIDEO_SUFFIXES:
        return VideoFile(path, calibration=options.calibration)
    # Reading recordings needs libraries that no other input does.
    if suffix == SESSION_SUFFIX:
        from services.camera.sources.recordings.mcap_file import open_mcap

        return open_mcap(path, options.topics, calibration=options.calibration)
    if suffix in _BAG_SUFFIXES:
        return _open_bag(path, options)
    raise InputError(f"input {path}: not an input that is known; {_EXPECTED}")


def _open_bag(path: Path, options: SourceOptions) -> Source:
    from services.camera.sources.recordings.ros_bag import open_ros_bag

    return open_ros_bag(path, options.topics, calibration=options.calibration)


def _open_folder(path: Path, options: SourceOptions) -> Source:
    for matches, open_it in _FOLDERS:
        if matches(path):
            return open_it(path, options)
    for inner in (drives_in(path), sequences_in(path)):
        if inner:
            raise InputError(f"input {path}: holds {len(inner)} sequences, expected one of them, such as {inner[0]}")
    what = "no images in this folder" if any(path.iterdir()) else "the folder is empty"
    raise InputError(f"input {path}: {what}; {_EXPECTED}")


def _is_bag_folder(path: Path) -> bool:
    return (path / _BAG_LISTING).is_file()


def _is_image_folder(path: Path) -> bool:
    return (path / "images").is_dir() or bool(list_images(path))


# The first that matches: what has a layout of its own before a mere folder of images.
_FOLDERS: tuple[tuple[Callable[[Path], bool], Callable[[Path, SourceOptions], Source]], ...] = (
    (_is_bag_folder, _open_bag),
    (is_tum_folder, lambda path, options: TumRgbd(path, calibration=options.calibration, depth=options.depth)),
    (is_euroc_folder, lambda path, options: Euroc(path, stereo=options.stereo, rectify_stereo=options.rectify)),
    (is_kitti_drive, lambda path, options: KittiRaw(path, left=options.kitti_left, stereo=options.stereo)),
    (
        is_kitti_folder,
        lambda path, options: KittiOdometry(
            path, left=options.kitti_left, stereo=options.stereo, rate_hz=options.rate_hz
        ),
    ),
    (
        is_tracking_sequence,
        lambda path, options: KittiTracking(path, stereo=options.stereo, rate_hz=options.rate_hz),
    ),
    (
        _is_image_folder,
        lambda path, options: ImageFolder(path, calibration=options.calibration, rate_hz=options.rate_hz),
    ),
)
