# SPDX-License-Identifier: Apache-2.0
"""Bags of ROS 1 and ROS 2 as inputs: topics, times, depth, calibration, truth, and bags that are broken."""

import dataclasses
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from services.camera.sources.recordings.message_source import MessageSource
from services.camera.sources.recordings.message_topics import TopicOptions
from services.camera.sources.recordings.ros_bag import open_ros_bag
from services.camera.sources.source import SourceFrame
from services.runtime.errors import InputError
from tests.unit.camera.bags import KINDS, NS_PER_S, Ros, Said

SIZE = (32, 24)
START_NS = 1_700_000_000_123_456_789
STEP_NS = 100_000_000
# base_link to camera_optical: 0.2 m ahead, 1 m up, then z forward.
CAMERA_ON_BASE = (0.2, 0.0, 1.0, -0.5, 0.5, -0.5, 0.5)


def _read_all(path: Path) -> None:
    source = open_ros_bag(path, TopicOptions("/cam/image_raw"))
    for index in range(source.frame_count):
        source.frame(index)


def _pixels(index: int) -> npt.NDArray[np.uint8]:
    return np.random.default_rng(index).integers(0, 256, (SIZE[1], SIZE[0], 3), dtype=np.uint8)


def _drive(ros: Ros, frames: int = 4) -> list[Said]:
    """Colour as rgb8 with padded rows, recorded late and out of order, camera info, depth, odometry, tf."""
    messages = [
        ros.info("/cam/camera_info", START_NS, SIZE),
        ros.static_transform(START_NS, "base_link", "mast", (0.2, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)),
        ros.static_transform(START_NS, "mast", "camera_optical", (0.0, 0.0, 0.0, *CAMERA_ON_BASE[3:])),
    ]
    for index in range(frames):
        stamp_ns = START_NS + STEP_NS * index
        rgb = _pixels(index)[..., ::-1]
        messages.append(ros.image("/cam/image_raw", stamp_ns, rgb, "rgb8", late_ns=5_000_000, padding=4))
        depth = np.full(SIZE[::-1], 1000 * (index + 1), np.uint16)
        depth[0, 0] = 0
        messages.append(ros.image("/cam/depth", stamp_ns + 8_000_000, depth, "16UC1"))
        messages.append(ros.odometry("/odom", stamp_ns - 20_000_000, (index - 0.2, 0, 0, 0, 0, 0, 1), "base_link"))
    return messages


@pytest.fixture(params=KINDS)
def ros(request: pytest.FixtureRequest) -> Ros:
    return Ros(request.param)


def _frame(source: MessageSource, index: int) -> SourceFrame:
    frame = source.frame(index)
    assert frame is not None
    return frame


def test_a_bag_gives_colour_depth_calibration_and_truth(ros: Ros, tmp_path: Path) -> None:
    options = TopicOptions("/cam/image_raw", depth="/cam/depth", truth="/odom")
    source = open_ros_bag(ros.write(tmp_path, _drive(ros)), options)
    assert (source.frame_count, source.rate_hz) == (4, 10)
    # Any order, as a camera that goes on in the middle asks.
    for index in (2, 0, 3, 1):
        frame = _frame(source, index)
        assert (frame.name, frame.timestamp_ns) == (f"{index:06d}", START_NS + STEP_NS * index)
        np.testing.assert_array_equal(frame.image.pixels, _pixels(index))
        assert frame.depth is not None
        assert (frame.depth.depth_m[0, 0], frame.depth.depth_m[5, 5]) == (0.0, index + 1.0)
        assert frame.calibration.intrinsics.tolist() == [[20, 0, 16], [0, 21, 12], [0, 0, 1]]
        assert frame.calibration.distortion == (0.1, -0.2, 0.001, 0.002, 0.0)
    pose = _frame(source, 1).true_pose
    assert pose is not None
    np.testing.assert_allclose(pose.world_from_camera[:3, 3], (1.0 + 0.2, 0.0, 1.0), atol=1e-6)
    np.testing.assert_allclose(pose.world_from_camera[:3, 2], (1, 0, 0), atol=1e-9)
    assert source.frame(4) is None
    # The last frame lies 20 ms behind the last odometry, which stands for it.
    assert _frame(source, 3).true_pose is not None
    source.close()


def test_without_depth_option_depth_stays_away(ros: Ros, tmp_path: Path) -> None:
    path = ros.write(tmp_path, _drive(ros))
    off = open_ros_bag(path, TopicOptions("/cam/image_raw", depth="/cam/depth", use_depth=False))
    assert _frame(off, 0).depth is None
    assert _frame(off, 0).true_pose is None


def test_compressed_images_and_times_of_recording(ros: Ros, tmp_path: Path) -> None:
    said = [ros.compressed("/cam/image_raw/compressed", 0, _pixels(index)) for index in range(3)]
    messages = [one._replace(recorded_ns=START_NS + index // 2) for index, one in enumerate(said)]
    messages.append(ros.info("/cam/camera_info", START_NS, SIZE))
    source = open_ros_bag(ros.write(tmp_path, messages), TopicOptions())
    # Headers without a time: the time of recording counts, and two messages of one time are one frame.
    assert source.frame_count == 2
    assert "1 of 3 messages of /cam/image_raw/compressed repeat a time and are left out" in source.notes
    frame = _frame(source, 1)
    assert frame.timestamp_ns == START_NS + 1
    np.testing.assert_array_equal(frame.image.pixels, _pixels(2))


def test_messages_come_by_the_times_of_their_headers(ros: Ros, tmp_path: Path) -> None:
    messages = [ros.info("/cam/camera_info", START_NS, SIZE)]
    for order, index in enumerate((0, 2, 1)):
        image = ros.image("/cam/image_raw", START_NS + STEP_NS * index, _pixels(index), "bgr8")
        messages.append(image._replace(recorded_ns=START_NS + order))
    source = open_ros_bag(ros.write(tmp_path, messages), TopicOptions())
    for index in range(3):
        np.testing.assert_array_equal(_frame(source, index).image.pixels, _pixels(index))


def test_rectified_images_have_the_projections_camera(ros: Ros, tmp_path: Path) -> None:
    messages = [
        ros.info("/cam/camera_info", START_NS, SIZE),
        ros.image("/cam/image_rect", START_NS, _pixels(0)[..., 0], "mono8"),
    ]
    source = open_ros_bag(ros.write(tmp_path, messages), TopicOptions())
    calibration = _frame(source, 0).calibration
    assert calibration.intrinsics.tolist() == [[18, 0, 15], [0, 19, 11], [0, 0, 1]]
    assert calibration.distortion == ()
    assert any("taken as rectified by its name" in note for note in source.notes)


def test_a_direct_camera_is_no_rectified_one(tmp_path: Path) -> None:
    ros = Ros("sqlite")
    image = ros.image("/direct/image_raw", START_NS, _pixels(0), "bgr8")
    source = open_ros_bag(ros.write(tmp_path, [ros.info("/direct/camera_info", START_NS, SIZE), image]), TopicOptions())
    assert _frame(source, 0).calibration.intrinsics[0, 0] == 20
    assert source.notes == ()


def test_a_pose_without_a_frame_is_taken_as_the_cameras(ros: Ros, tmp_path: Path) -> None:
    messages = [*_drive(ros), ros.pose("/vicon", START_NS, (1, 2, 3, 0, 0, 0, 1))]
    source = open_ros_bag(ros.write(tmp_path, messages), TopicOptions("/cam/image_raw", truth="/vicon"))
    pose = _frame(source, 0).true_pose
    assert pose is not None
    np.testing.assert_allclose(pose.world_from_camera[:3, 3], (1, 2, 3))
    assert any("/vicon: its poses are taken as the camera's own" in note for note in source.notes)
    assert any("3 of 4 frames have no true pose" in note for note in source.notes)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (
            TopicOptions(),
            r"2 image topics, expected camera\.topic to name one of /cam/image_raw .*, /cam/second \(sensor_msgs",
        ),
        (
            TopicOptions("/front"),
            r"camera\.topic /front, expected one of its image topics: /cam/depth .*, /cam/image_raw",
        ),
        (TopicOptions("/odom"), r"camera\.topic /odom, expected one of its image topics"),
        (TopicOptions("/cam/image_raw", depth="/d"), r"camera\.depth_topic /d, expected one of its image topics"),
        (TopicOptions("/cam/image_raw", info="/i"), r"camera\.info_topic /i, .* calibration topics: /cam/camera_info"),
        (TopicOptions("/cam/image_raw", truth="/t"), r"camera\.truth_topic /t, expected one of its pose topics: /odom"),
        (TopicOptions("/cam/depth"), "/cam/depth message 0: encoding '16UC1', expected one of mono8"),
        (
            TopicOptions("/cam/image_raw", depth="/cam/image_raw"),
            "encoding 'rgb8', expected one of 16UC1, mono16, 32FC1",
        ),
    ],
)
def test_topics_that_do_not_fit_are_listed(tmp_path: Path, options: TopicOptions, said: str) -> None:
    ros = Ros("sqlite")
    second = ros.image("/cam/second", START_NS, _pixels(0), "bgr8")
    path = ros.write(tmp_path, [*_drive(ros), second])
    with pytest.raises(InputError, match=said) as caught:
        open_ros_bag(path, options)
    assert "\n" not in str(caught.value)


def test_calibrations_that_do_not_fit(tmp_path: Path) -> None:
    ros = Ros("ros1")
    image = ros.image("/cam/image_raw", START_NS, _pixels(0), "bgr8")

    def said_of(name: str, *info: Said) -> str:
        (tmp_path / name).mkdir()
        with pytest.raises(InputError) as caught:
            open_ros_bag(ros.write(tmp_path / name, [image, *info]), TopicOptions())
        return str(caught.value)

    assert "no calibration: expected" in said_of("none")
    assert "drive.bag /cam/camera_info: 64x48 px, expected 32x24" in said_of(
        "size", ros.info("/cam/camera_info", START_NS, (64, 48))
    )
    assert "focal lengths 0 and 0 px" in said_of("focal", ros.info("/cam/camera_info", START_NS, SIZE, focal=0.0))
    assert "/cam/camera_info: last row of K [0.0, 0.0, 2.0], expected 0 0 1" in said_of(
        "scaled", ros.info("/cam/camera_info", START_NS, SIZE, focal=2.0)
    )
    assert "/cam/camera_info: distortion (nan, 0.0, 0.0, 0.0, 0.0), expected finite numbers" in said_of(
        "nan", ros.info("/cam/camera_info", START_NS, SIZE, d=(float("nan"), 0.0, 0.0, 0.0, 0.0))
    )
    assert "distortion 'equidistant' of 4 coefficients, expected plumb_bob's" in said_of(
        "fisheye", ros.info("/cam/camera_info", START_NS, SIZE, model="equidistant", d=(0.1, 0.2, 0.3, 0.4))
    )
    (tmp_path / "none" / "drive.toml").write_text("fx = 9.0\nfy = 9.0\ncx = 16.0\ncy = 12.0\nwidth = 32\nheight = 24\n")
    own = open_ros_bag(tmp_path / "none" / "drive.bag", TopicOptions())
    assert _frame(own, 0).calibration.intrinsics[0, 0] == 9


def test_a_bag_that_is_cut_off_is_one_line(ros: Ros, tmp_path: Path) -> None:
    path = ros.write(tmp_path, _drive(ros, frames=30))
    file = path if path.is_file() else next(file for file in path.iterdir() if file.suffix != ".yaml")
    file.write_bytes(file.read_bytes()[: file.stat().st_size * 3 // 5])
    with pytest.raises(InputError, match=r"bag .*drive.*: cut off or damaged") as caught:
        _read_all(path)
    assert "\n" not in str(caught.value)
    file.write_bytes(b"nothing of the kind")
    with pytest.raises(InputError, match="cut off or damaged"):
        open_ros_bag(path, TopicOptions())


def test_an_image_of_another_size_is_named(ros: Ros, tmp_path: Path) -> None:
    messages = _drive(ros)
    small = ros.image("/cam/image_raw", START_NS + 9 * STEP_NS, np.zeros((5, 6), np.uint8), "mono8")
    options = TopicOptions("/cam/image_raw", use_depth=False)
    source = open_ros_bag(ros.write(tmp_path, [*messages, small]), options)
    with pytest.raises(InputError, match="/cam/image_raw message 4: 6x5 px, expected 32x24 as the first image"):
        source.frame(4)


def test_depth_of_the_images_own_frame_is_taken_without_being_named(ros: Ros, tmp_path: Path) -> None:
    source = open_ros_bag(ros.write(tmp_path, _drive(ros)), TopicOptions())
    depth = _frame(source, 2).depth
    assert depth is not None
    assert depth.depth_m[5, 5] == 3.0
    assert "/cam/depth is taken as the images' depth: same size and frame" in source.notes


@pytest.mark.parametrize("why", ["frame", "size", "encoding", "several", "few"])
def test_depth_that_is_not_the_images_needs_to_be_named(tmp_path: Path, why: str) -> None:
    ros = Ros("sqlite")
    images = [ros.image("/cam/image_raw", START_NS + STEP_NS * index, _pixels(index), "bgr8") for index in range(4)]
    size = (5, 6) if why == "size" else SIZE[::-1]
    levels = np.full(size, 100, np.uint8 if why == "encoding" else np.uint16)
    depth = ros.image("/cam/depth", START_NS, levels, "8UC1" if why == "encoding" else "16UC1")
    depths = [depth._replace(recorded_ns=START_NS + index) for index in range(1)] if why == "few" else []
    if why != "few":
        depths = [
            ros.image("/cam/depth", START_NS + STEP_NS * index, levels, depth.message.encoding) for index in range(4)
        ]
    if why == "several":
        depths += [one._replace(topic="/other/depth") for one in depths]
    if why == "frame":
        moved = ros.header(START_NS, "depth_optical")
        depths = [one._replace(message=dataclasses.replace(one.message, header=moved)) for one in depths]
    info = ros.info("/cam/camera_info", START_NS, SIZE)
    source = open_ros_bag(ros.write(tmp_path, [info, *images, *depths]), TopicOptions())
    assert source.frame_count == 4
    assert _frame(source, 0).depth is None
    (note,) = [note for note in source.notes if "depth" in note]
    said = {
        "several": "several could be the images' depth (/cam/depth, /other/depth)",
        "few": "only 1 of 4 images have one within 0.02 s (/cam/depth)",
    }.get(why, "none is of the images' size and frame (/cam/depth)")
    assert note == f"depth is not used: {said}; camera.depth_topic names one"


def test_nonsense_times_and_transforms_are_one_line(tmp_path: Path) -> None:
    ros = Ros("sqlite")
    info = ros.info("/cam/camera_info", START_NS, SIZE)
    early = ros.image("/cam/image_raw", -5 * NS_PER_S, _pixels(0), "bgr8")._replace(recorded_ns=START_NS)
    with pytest.raises(InputError, match="/cam/image_raw: time -5000000000 ns, expected times from 1970 on"):
        open_ros_bag(ros.write(tmp_path, [info, early]), TopicOptions())
    nowhere = ros.static_transform(START_NS, "base_link", "camera_optical", (0, 0, 0, 0, 0, 0, 0))
    odometry = ros.odometry("/odom", START_NS, (0, 0, 0, 0, 0, 0, 1), "base_link")
    image = ros.image("/cam/image_raw", START_NS, _pixels(0), "bgr8")
    (tmp_path / "tf").mkdir()
    path = ros.write(tmp_path / "tf", [info, image, nowhere, odometry])
    with pytest.raises(InputError, match=r"/tf_static: camera_optical in base_link is at .* expected a position and a"):
        open_ros_bag(path, TopicOptions(truth="/odom"))
