# SPDX-License-Identifier: Apache-2.0
"""The simulator's street as a source."""

import numpy as np
import pytest

from services.camera.sources.simulator import Simulator
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
