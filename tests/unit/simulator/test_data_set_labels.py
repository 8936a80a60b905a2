# SPDX-License-Identifier: Apache-2.0
"""What KITTI's labels say beyond boxes: how much is hidden or cut off, and who rides on what."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from services.simulator.data_sets.silhouette import silhouette
from services.simulator.data_sets.tracking_labels import TrackingLabels
from services.simulator.drive import Drive
from services.simulator.frame import SimulatedFrame
from tests.unit.simulator.data_set_drive import TINY


@dataclass
class FlatCamera:
    """100 x 50 px, a focal length of 100 px."""

    width: int = 100
    height: int = 50

    def project(self, points_in_camera: np.ndarray) -> np.ndarray:
        return points_in_camera[..., :2] / points_in_camera[..., 2:] * 100.0 + [49.5, 24.5]


def _square(left: float, top: float, side: float, depth: float = 100.0) -> np.ndarray:
    """Two triangles whose image has its corner at (left, top) px."""
    x, y = (np.array([left, top]) - [49.5, 24.5]) * depth / 100.0
    side *= depth / 100.0
    corners = np.array([[x, y], [x + side, y], [x + side, y + side], [x, y + side]])
    corners = np.hstack([corners, np.full((4, 1), depth)])
    return corners[[[0, 1, 2], [0, 2, 3]]]


@pytest.mark.parametrize("side", [4.0, 20.0])
@pytest.mark.parametrize("depth", [2.0, 100.0])
def test_a_square_in_the_image(side: float, depth: float) -> None:
    found = silhouette(FlatCamera(), _square(30.25, 10.5, side, depth))
    assert found is not None
    assert found.whole_px == pytest.approx(side**2, rel=0.03)
    assert found.inside_px == pytest.approx(found.whole_px)
    assert found.box_px == pytest.approx((30.25, 10.5, 30.25 + side, 10.5 + side), abs=0.02 * side)


def test_a_square_that_the_border_cuts() -> None:
    found = silhouette(FlatCamera(), _square(89.5, 39.5, 20.0))
    assert found is not None
    assert found.inside_px / found.whole_px == pytest.approx(0.25, abs=0.02)
    assert found.box_px == pytest.approx((89.5, 39.5, 99.0, 49.0), abs=0.3)


def test_what_is_beside_or_behind_the_image() -> None:
    assert silhouette(FlatCamera(), _square(130.0, 10.0, 20.0)) is None
    assert silhouette(FlatCamera(), _square(30.0, 10.0, 20.0) * [1.0, 1.0, -1.0]) is None


@pytest.fixture(scope="module")
def drive() -> Drive:
    return Drive(TINY)


@pytest.fixture(scope="module")
def frame(drive: Drive) -> SimulatedFrame:
    return drive.render(1)


def test_hidden_and_cut_off_objects_are_said_to_be_so(drive: Drive, frame: SimulatedFrame) -> None:
    labels = TrackingLabels(drive)
    boxes = labels.boxes(frame)
    biggest = max(frame.instances, key=lambda item: item.visible_px)
    share = {1.0: 0, 0.7: 1, 0.2: 2}
    full = boxes[biggest.instance_id]
    assert full.occluded == 0
    for visible, level in share.items():
        part = replace(biggest, visible_px=round(visible * biggest.visible_px))
        hidden = labels.boxes(replace(frame, instances=[part]))[biggest.instance_id]
        assert hidden.occluded == level
        assert hidden.place_m == full.place_m
    assert {box.occluded for box in boxes.values()} == {0, 1, 2}


class _Riding:
    """A drive in which the walker `rider` pushes nothing but rides a bicycle that is where he is."""

    def __init__(self, drive: Drive, rider: int) -> None:
        person = next(actor for actor in drive.actors if actor.instance_id == rider)
        self.bicycle = replace(person, instance_id=999, category="bicycle", size_m=(1.8, 0.6, 1.1))
        self.actors = [*drive.actors, self.bicycle]
        self.camera, self.frame_count, self.timestamp_ns = drive.camera, drive.frame_count, drive.timestamp_ns


def test_a_bicycle_and_its_rider_are_one_cyclist(drive: Drive, frame: SimulatedFrame) -> None:
    person = max((i for i in frame.instances if i.category == "person"), key=lambda item: item.visible_px)
    riding = _Riding(drive, person.instance_id)
    bicycle = replace(person, instance_id=999, category="bicycle", size_m=riding.bicycle.size_m)
    labels = TrackingLabels(riding)  # type: ignore[arg-type]
    both = labels.boxes(replace(frame, instances=[person, bicycle]))
    assert set(both) == {999}
    assert (both[999].category, both[999].object_id) == ("Cyclist", 999)
    assert both[999].size_m[1:] == (0.6, 1.8)
    assert both[999].size_m[0] == pytest.approx(person.size_m[2], abs=0.3)
    rider_alone = labels.boxes(replace(frame, instances=[person]))
    assert (rider_alone[person.instance_id].category, rider_alone[person.instance_id].object_id) == ("Cyclist", 999)
    others = [item for item in frame.instances if item.instance_id != person.instance_id]
    assert "Cyclist" not in {box.category for box in labels.boxes(replace(frame, instances=others)).values()}


def test_a_bicycle_alone_and_a_bus_are_misc(drive: Drive, frame: SimulatedFrame) -> None:
    labels = TrackingLabels(drive)
    for category, name in {"bicycle": "Misc", "bus": "Misc", "truck": "Truck", "car": "Car"}.items():
        item = replace(frame.instances[0], category=category)
        assert labels.boxes(replace(frame, instances=[item]))[item.instance_id].category == name
