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
from services.camera.sources.image_folder import ImageFolder
from services.camera.sources.kitti_odometry import KittiOdometry
from services.camera.sources.mcap_session import McapSession
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


def _open(given: Path | str, **options: object) -> Source:
    return open_source(str(given), SourceOptions(**options), DriveOptions())  # type: ignore[arg-type]


def test_each_input_finds_its_source(kitti: Path, image_folder: Path, video: Path) -> None:
    assert isinstance(_open(kitti), KittiOdometry)
    assert isinstance(_open(image_folder), ImageFolder)
    assert isinstance(_open(video), VideoFile)
    assert isinstance(_open("simulator"), Simulator)


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
