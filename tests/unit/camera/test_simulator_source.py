# SPDX-License-Identifier: Apache-2.0
"""The simulator as a source."""

import numpy as np
import pytest

from schemas.codec.camera import calibration_to_message, calibration_to_record
from services.camera.sources.simulator import Simulator
from services.runtime.errors import InputError
from services.simulator.options import DriveOptions


@pytest.fixture(scope="module")
def simulator() -> Simulator:
    return Simulator(DriveOptions(width=160, height=96, frames=200))


def test_a_frame_has_all_its_truth(simulator: Simulator) -> None:
    frame = simulator.frame(150)
    assert frame is not None
    assert frame.depth is not None
    assert frame.true_pose is not None
    assert frame.true_instances is not None
    assert frame.timestamp_ns == 15_000_000_000
    assert frame.image.pixels.shape == (96, 160, 3)
    assert frame.depth.depth_m.shape == frame.true_instances.labels.shape == (96, 160)
    assert (frame.calibration.width, frame.calibration.height) == (160, 96)
    assert frame.true_pose.world_from_camera.shape == (4, 4)
    present = set(np.unique(frame.true_instances.labels)) - {0}
    assert present == {item.instance_id for item in frame.true_instances.objects}
    assert present
    records = (frame.image, frame.calibration, frame.depth, frame.true_pose, frame.true_instances)
    assert {record.timestamp_ns for record in records} == {frame.timestamp_ns}


def test_the_drive_has_an_end_and_any_order_is_the_same(simulator: Simulator) -> None:
    assert simulator.frame_count == 200
    assert simulator.frame(200) is None
    late, early = simulator.frame(199), simulator.frame(0)
    assert late is not None
    assert early is not None
    other = Simulator(DriveOptions(width=160, height=96, frames=200)).frame(199)
    assert other is not None
    np.testing.assert_array_equal(late.image.pixels, other.image.pixels)
    assert (late.name, early.name) == ("000199", "000000")


def test_objects_have_their_cuboids(simulator: Simulator) -> None:
    frame = simulator.frame(150)
    assert frame is not None
    assert frame.true_instances is not None
    for found in frame.true_instances.objects:
        assert found.size_m is not None
        length, width, height = found.size_m
        assert 0.3 < width < 3.0
        assert 0.3 < length < 20.0
        assert 1.0 < height < 5.0
    assert len({found.heading_rad for found in frame.true_instances.objects}) > 1


def test_a_pair_behind_a_lens_says_what_it_is() -> None:
    options = DriveOptions(
        width=160, height=96, lens="fisheye", distortion=(0.02, -0.01, 0.0, 0.0), stereo_baseline_m=0.5
    )
    frame = Simulator(options).frame(0)
    assert frame is not None
    assert frame.image_right is not None
    assert frame.calibration_right is not None
    assert frame.calibration_right.projection is not None
    assert frame.calibration.projection is not None
    assert frame.calibration.projection[0, 3] == 0.0
    assert frame.calibration_right.projection[0, 3] == pytest.approx(-0.5 * frame.calibration.intrinsics[0, 0])
    for calibration in (frame.calibration, frame.calibration_right):
        assert calibration.distortion_model == "kannala_brandt"
        assert calibration.distortion == (0.02, -0.01, 0.0, 0.0)
    message = calibration_to_message(frame.calibration_right)
    assert (message.distortion_model, list(message.D)) == ("kannala_brandt", [0.02, -0.01, 0.0, 0.0])
    assert calibration_to_record(message).distortion_model == "kannala_brandt"
    assert not np.array_equal(frame.image.pixels, frame.image_right.pixels)
    assert (frame.image.frame_id, frame.image_right.frame_id) == ("camera", "camera_right")


def test_one_camera_has_no_right_one(simulator: Simulator) -> None:
    frame = simulator.frame(0)
    assert frame is not None
    assert frame.image_right is None
    assert frame.calibration_right is None
    assert frame.calibration.distortion == ()


def test_a_lens_that_shows_nothing_is_refused_at_once() -> None:
    options = DriveOptions(lens="radial", distortion=(-2.0, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(InputError, match=r"distortion=\(-2.0, 0.0, 0.0, 0.0, 0.0\): expected a radial lens"):
        Simulator(options)
