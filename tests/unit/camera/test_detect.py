# SPDX-License-Identifier: Apache-2.0
"""Which source an input is, from the configuration."""

from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from schemas.codec import encode
from services.camera.configured_source import open_configured_source
from services.camera.frame_records import frame_records
from services.camera.sources.detect import SourceOptions, open_source
from services.camera.sources.folders.euroc import Euroc
from services.camera.sources.folders.image_folder import ImageFolder
from services.camera.sources.folders.tum_rgbd import TumRgbd
from services.camera.sources.kitti.odometry import KittiOdometry
from services.camera.sources.kitti.raw import KittiRaw
from services.camera.sources.kitti.tracking import KittiTracking
from services.camera.sources.recordings.mcap_session import McapSession
from services.camera.sources.recordings.message_source import MessageSource
from services.camera.sources.simulator import Simulator
from services.camera.sources.source import Source
from services.camera.sources.video_file import VideoFile
from services.recorder.session_writer import SessionWriter
from services.runtime.config import Config
from services.runtime.config.camera import CameraConfig
from services.runtime.config.simulator import SimulatorConfig
from services.runtime.errors import InputError
from services.runtime.session_file import RecordedMessage
from services.simulator.options import DriveOptions
from tests.unit.camera.bags import KINDS, Ros
from tests.unit.camera.conftest import CALIBRATION, P0


def _open(given: Path | str, **options: object) -> Source:
    return open_source(str(given), SourceOptions(**options), DriveOptions())  # type: ignore[arg-type]


def test_each_input_finds_its_source(kitti: Path, image_folder: Path, video: Path) -> None:
    assert isinstance(_open(kitti), KittiOdometry)
    assert isinstance(_open(image_folder), ImageFolder)
    assert isinstance(_open(video), VideoFile)
    assert isinstance(_open("simulator"), Simulator)


def test_tum_and_euroc_folders_are_known(tmp_path: Path, make_images: Callable[..., Path]) -> None:
    make_images("tum/rgb", 1)
    (tmp_path / "tum/rgb.txt").write_text("1.5 rgb/000000.png\n")
    (tmp_path / "tum/calibration.toml").write_text(CALIBRATION)
    assert isinstance(_open(tmp_path / "tum"), TumRgbd)
    make_images("euroc/mav0/cam0/data", 1)
    (tmp_path / "euroc/mav0/cam0/data.csv").write_text("#timestamp [ns],filename\n5,000000.png\n")
    (tmp_path / "euroc/mav0/cam0/sensor.yaml").write_text(
        "T_BS:\n  data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\nrate_hz: 20\nresolution: [32, 24]\n"
        "camera_model: pinhole\nintrinsics: [20, 20, 16, 12]\ndistortion_model: radial-tangential\n"
        "distortion_coefficients: [0, 0, 0, 0]\n"
    )
    assert isinstance(_open(tmp_path / "euroc"), Euroc)
    assert isinstance(_open(tmp_path / "euroc/mav0"), Euroc)


def test_kitti_drives_and_tracking_sequences_are_known(tmp_path: Path, make_images: Callable[..., Path]) -> None:
    make_images("2011_09_26/drive_sync/image_00/data", 1)
    (tmp_path / "2011_09_26/calib_cam_to_cam.txt").write_text(f"{P0.replace('P0', 'P_rect_00')}\nS_rect_00: 32 24\n")
    (tmp_path / "2011_09_26/drive_sync/image_00/timestamps.txt").write_text("2011-09-26 13:02:25.964389445\n")
    assert isinstance(_open(tmp_path / "2011_09_26/drive_sync"), KittiRaw)
    with pytest.raises(InputError, match=r"2011_09_26: holds 1 sequences, expected one of them, such as .*drive_sync"):
        _open(tmp_path / "2011_09_26")
    make_images("training/image_02/0000", 1)
    (tmp_path / "training/calib").mkdir()
    (tmp_path / "training/calib/0000.txt").write_text(f"{P0}\n")
    assert isinstance(_open(tmp_path / "training/image_02/0000"), KittiTracking)
    for above in ("training", "training/image_02"):
        with pytest.raises(InputError, match=r"holds 1 sequences, expected one of them, such as .*image_02/0000"):
            _open(tmp_path / above)


@pytest.mark.parametrize("kind", KINDS)
def test_bags_are_known_by_folder_and_by_file(tmp_path: Path, kind: str) -> None:
    ros = Ros(kind)
    images = [ros.image("/cam/image", 10**9 + step, np.zeros((24, 32), np.uint8), "mono8") for step in (0, 1)]
    other = ros.image("/other/image", 10**9, np.zeros((24, 32), np.uint8), "mono8")
    path = ros.write(tmp_path, [ros.info("/cam/camera_info", 10**9, (32, 24)), *images, other])
    for given in (path, *path.glob("*.db3"), *path.glob("*.mcap")):
        source = _open(given, topic="/cam/image")
        assert isinstance(source, MessageSource)
        assert source.frame_count == 2
        source.close()
        with pytest.raises(InputError, match=r"2 image topics, expected camera\.topic to name one of /cam/image"):
            _open(given)


def test_a_camera_that_is_not_there_is_no_folder() -> None:
    with pytest.raises(InputError, match="camera /dev/video97: gives no frame"):
        _open("/dev/video97")


def test_a_session_gives_the_frames_it_recorded(tmp_path: Path, kitti: Path) -> None:
    path = tmp_path / "session.mcap"
    source = _open(kitti)
    writer = SessionWriter(path, "a-session")
    frames = [frame for index in range(3) if (frame := source.frame(index)) is not None]
    for sequence, frame in enumerate(frames):
        records = frame_records(frame, source)
        writer.append(
            [RecordedMessage(t.key, sequence, frame.timestamp_ns, encode(t, record)) for t, record in records]
        )
    writer.finish()
    writer.close()
    session = _open(path, max_frames=2)
    assert isinstance(_open(path), McapSession)
    assert session.frame_count == 2
    again = session.frame(1)
    assert again is not None
    assert (again.name, again.timestamp_ns) == (frames[1].name, frames[1].timestamp_ns)
    np.testing.assert_array_equal(again.image.pixels, frames[1].image.pixels)
    path.write_bytes(b"not MCAP at all")
    with pytest.raises(InputError, match=r"session\.mcap: not an MCAP file"):
        _open(path)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("missing", r"input .*missing: no such file or folder; expected a KITTI odometry folder"),
        ("empty", r"input .*empty: the folder is empty; expected a KITTI"),
        ("other", r"input .*other: no images in this folder; expected a KITTI"),
        ("other/notes.txt", r"input .*notes\.txt: not an input that is known; expected"),
    ],
)
def test_what_is_no_input_says_what_was_expected(tmp_path: Path, name: str, said: str) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "notes.txt").touch()
    with pytest.raises(InputError, match=said) as caught:
        _open(tmp_path / name)
    assert "\n" not in str(caught.value)


def test_an_empty_image_folder_of_kitti_is_named(kitti: Path, make_images: Callable[..., Path]) -> None:
    make_images("sequences/00/image_2", 0)
    with pytest.raises(InputError, match=r"image_2: no images"):
        _open(kitti)
    assert _open(kitti, kitti_images="image_0").frame_count == 3


def test_only_the_first_frames(kitti: Path) -> None:
    source = _open(kitti, max_frames=2)
    assert source.frame_count == 2
    assert source.frame(1) is not None
    assert source.frame(2) is None
    assert "only the first 2 frames" in source.notes
    assert _open(kitti, max_frames=9).frame_count == 3


def test_configuration_reaches_the_source(kitti: Path) -> None:
    config = Config()
    config.camera = CameraConfig(input=str(kitti), max_frames=1)
    assert open_configured_source(config).frame_count == 1
    config.camera = CameraConfig()
    config.simulator = SimulatorConfig(frames=11, rate_hz=5)
    simulator = open_configured_source(config)
    assert (simulator.frame_count, simulator.rate_hz) == (11, 5)


def test_simulator_section_says_what_the_street_can_be_asked_for() -> None:
    defaults = {field.name: field.default for field in fields(DriveOptions)}
    assert SimulatorConfig().model_dump() == defaults


def test_camera_section_has_every_source_option() -> None:
    defaults = {field.name: field.default for field in fields(SourceOptions)}
    assert CameraConfig().model_dump(exclude={"input"}) == defaults
