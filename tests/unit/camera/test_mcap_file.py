# SPDX-License-Identifier: Apache-2.0
"""MCAP files of others: Foxglove's messages as protobuf, ROS 2's as CDR; kinemap's own stay sessions."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from google.protobuf.timestamp_pb2 import Timestamp
from mcap.writer import Writer as McapWriter
from mcap_protobuf.writer import Writer

from services.camera.sources.recordings.mcap_file import open_mcap
from services.camera.sources.recordings.message_source import MessageSource
from services.camera.sources.recordings.message_topics import TopicOptions
from services.camera.sources.source import Source, SourceFrame
from services.runtime.errors import InputError
from tests.unit.camera.bags import Ros

SIZE = (32, 24)
START_NS = 1_700_000_000_000_000_000
STEP_NS = 50_000_000


def _pixels(index: int) -> npt.NDArray[np.uint8]:
    return np.random.default_rng(index).integers(0, 256, (SIZE[1], SIZE[0], 3), dtype=np.uint8)


def _time(time_ns: int) -> Timestamp:
    stamp = Timestamp()
    stamp.FromNanoseconds(time_ns)
    return stamp


def _raw(index: int, **changed: Any) -> RawImage:
    fields = {
        "timestamp": _time(START_NS + STEP_NS * index),
        "frame_id": "cam",
        "width": SIZE[0],
        "height": SIZE[1],
        "encoding": "rgb8",
        "step": 3 * SIZE[0],
        "data": _pixels(index)[..., ::-1].tobytes(),
    }
    return RawImage(**{**fields, **changed})


def _calibration(**changed: Any) -> CameraCalibration:
    fields = {"width": SIZE[0], "height": SIZE[1], "distortion_model": "plumb_bob", "D": [0.1, 0.0, 0.0, 0.0, 0.0]}
    return CameraCalibration(**{**fields, "K": [20, 0, 16, 0, 21, 12, 0, 0, 1], **changed})


def _write(path: Path, *messages: tuple[str, Any]) -> Path:
    with path.open("wb") as stream, Writer(stream) as writer:
        for number, (topic, message) in enumerate(messages):
            writer.write_message(topic, message, START_NS + number, START_NS + number)
    return path


def _frame(source: Source, index: int) -> SourceFrame:
    frame = source.frame(index)
    assert frame is not None
    return frame


def test_foxglove_images_with_depth_calibration_and_truth(tmp_path: Path) -> None:
    depth = np.full(SIZE[::-1], 2.5, np.float32)
    messages: list[tuple[str, Any]] = [("/calibration", _calibration())]
    for index in range(3):
        messages.append(("/camera", _raw(index)))
        raw = {"encoding": "32FC1", "step": 4 * SIZE[0], "data": depth.tobytes()}
        messages.append(("/depth", _raw(index, **raw)))
        pose = PoseInFrame(timestamp=_time(START_NS + STEP_NS * index))
        pose.pose.position.x, pose.pose.orientation.w = index, 1.0
        messages.append(("/truth", pose))
    path = _write(tmp_path / "drive.mcap", *messages)
    source = open_mcap(path, TopicOptions("/camera", depth="/depth", truth="/truth"))
    assert isinstance(source, MessageSource)
    assert (source.frame_count, source.rate_hz) == (3, 20)
    for index in (2, 0, 1):
        frame = _frame(source, index)
        assert frame.timestamp_ns == START_NS + STEP_NS * index
        np.testing.assert_array_equal(frame.image.pixels, _pixels(index))
        assert frame.depth is not None
        assert frame.depth.depth_m[3, 3] == 2.5
        assert frame.true_pose is not None
        assert frame.true_pose.world_from_camera[0, 3] == index
        assert frame.calibration.distortion == (0.1, 0.0, 0.0, 0.0, 0.0)
    source.close()


def test_compressed_images_alone_find_their_topic(tmp_path: Path) -> None:
    jpeg = cv2.imencode(".jpg", np.full((*SIZE[::-1], 3), 120, np.uint8))[1].tobytes()
    image = CompressedImage(timestamp=_time(START_NS), data=jpeg, format="jpeg")
    path = _write(tmp_path / "drive.mcap", ("/camera", image), ("/calibration", _calibration()))
    np.testing.assert_allclose(_frame(open_mcap(path, TopicOptions()), 0).image.pixels, 120, atol=2)


def test_ros2_in_mcap_without_its_folder(tmp_path: Path) -> None:
    ros = Ros("mcap")
    images = [ros.image("/cam/image_raw", START_NS + STEP_NS * i, _pixels(i), "bgr8") for i in range(3)]
    bag = ros.write(tmp_path, [ros.info("/cam/camera_info", START_NS, SIZE), *images])
    source = open_mcap(next(bag.glob("*.mcap")), TopicOptions())
    assert source.frame_count == 3
    np.testing.assert_array_equal(_frame(source, 1).image.pixels, _pixels(1))


def test_what_cannot_be_used_is_one_line(tmp_path: Path) -> None:
    def said_of(*messages: tuple[str, Any]) -> str:
        with pytest.raises(InputError) as caught:
            open_mcap(_write(tmp_path / "drive.mcap", *messages), TopicOptions())
        assert "\n" not in str(caught.value)
        return str(caught.value)

    assert "no image topic, expected images" in said_of(("/truth", PoseInFrame()))
    assert "no calibration: expected" in said_of(("/camera", _raw(0)))
    assert "K of 0 numbers, expected 9" in said_of(("/camera", _raw(0)), ("/c", _calibration(K=[])))
    assert "/c: 64x24 px, expected 32x24" in said_of(("/camera", _raw(0)), ("/c", _calibration(width=64)))
    assert "encoding 'nv12'" in said_of(("/camera", _raw(0, encoding="nv12")))


def test_an_encoding_that_is_not_known_is_named(tmp_path: Path) -> None:
    path = tmp_path / "drive.mcap"
    with path.open("wb") as stream:
        writer = McapWriter(stream)
        writer.start()
        schema = writer.register_schema("sensor_msgs/Image", "ros1msg", b"")
        writer.register_channel("/cam/image_raw", "ros1", schema)
        writer.finish()
    with pytest.raises(InputError, match=r"drive\.mcap: messages encoded as ros1, expected cdr \(ROS 2\) or protobuf"):
        open_mcap(path, TopicOptions())


def test_a_file_that_is_cut_off_says_so(tmp_path: Path) -> None:
    path = _write(tmp_path / "drive.mcap", *(("/camera", _raw(index)) for index in range(20)))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(InputError, match=r"drive\.mcap: cut off or without an index, expected a whole MCAP file"):
        open_mcap(path, TopicOptions())
    path.write_bytes(b"no MCAP at all")
    with pytest.raises(InputError, match=r"drive\.mcap: not an MCAP file"):
        open_mcap(path, TopicOptions())


def test_a_damaged_message_ends_in_one_line(tmp_path: Path) -> None:
    path = _write(tmp_path / "drive.mcap", ("/c", _calibration()), *(("/camera", _raw(i)) for i in range(40)))
    source = open_mcap(path, TopicOptions())
    content = bytearray(path.read_bytes())
    content[200:-2000] = bytes(len(content) - 2200)
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"drive\.mcap: cut off or damaged") as caught:
        source.frame(39)
    assert "\n" not in str(caught.value)


def test_a_byte_that_changed_on_disk_is_no_other_picture(tmp_path: Path) -> None:
    path = _write(tmp_path / "drive.mcap", ("/calibration", _calibration()), *(("/camera", _raw(i)) for i in range(3)))
    data = bytearray(path.read_bytes())
    # Noise does not compress: the pixels lie in the file as they are.
    place = data.find(_pixels(2)[..., ::-1].tobytes()[1000:1100])
    assert place > 0
    data[place] ^= 1
    path.write_bytes(data)
    with pytest.raises(InputError, match="cut off or damaged") as caught:
        _frame(open_mcap(path, TopicOptions()), 2)
    assert "\n" not in str(caught.value)


def test_a_damaged_end_is_one_line(tmp_path: Path) -> None:
    whole = _write(tmp_path / "whole.mcap", ("/calibration", _calibration()), ("/camera", _raw(0))).read_bytes()
    path = tmp_path / "drive.mcap"
    # Where the footer was, a record of a kind nobody knows that reaches into the magic behind it.
    path.write_bytes(whole[:-37] + b"\x7f" + (24).to_bytes(8, "little") + whole[-28:])
    with pytest.raises(InputError, match=r"drive\.mcap: cut off or without an index") as caught:
        open_mcap(path, TopicOptions())
    assert "\n" not in str(caught.value)
