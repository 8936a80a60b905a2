# SPDX-License-Identifier: Apache-2.0
"""Both ways to deliver, without a bus and without a clock."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from schemas.records import CameraCalibration, Image
from services.camera.delivery import Delivery, Parcel
from services.camera.lossless import LosslessDelivery
from services.camera.pacing import Pacing
from services.camera.position import Position, PositionFile
from services.camera.realtime import RealtimeDelivery
from services.camera.sources.source import SourceFrame
from services.runtime.errors import ResourceError
from services.runtime.frame_window import FrameWindow

SERVICES = ("slam", "recorder")
STEP_NS = 100_000_000


class Outlet:
    """Remembers what was sent; the end is named -n."""

    def __init__(self) -> None:
        self.sent: list[int] = []
        self.parcels: list[Parcel] = []

    def pack(self, sequence: int, frame: SourceFrame) -> Parcel:
        return Parcel(sequence, frame.timestamp_ns, ())

    def pack_end(self, frame_count: int, timestamp_ns: int) -> Parcel:
        return Parcel(frame_count, timestamp_ns, ())

    def send(self, parcel: Parcel) -> None:
        self.parcels.append(parcel)
        self.sent.append(parcel.sequence)


class Camera:
    """A delivery with its source of `count` frames."""

    def __init__(self, delivery: Delivery, outlet: Outlet, first: int, count: int) -> None:
        self.delivery = delivery
        self.outlet = outlet
        self._index = first
        self._count = count

    def step(self, now_s: float) -> float:
        if self.delivery.wants_frame:
            self.delivery.offer(_frame(self._index) if self._index < self._count else None, now_s)
            self._index += 1
        return self.delivery.step(now_s)

    def answer(self, sequence: int) -> None:
        for service in SERVICES:
            self.delivery.answered(service, sequence)


def _frame(index: int) -> SourceFrame:
    time_ns = index * STEP_NS
    image = Image(time_ns, np.zeros((2, 2), dtype=np.uint8))
    return SourceFrame(str(index), time_ns, image, CameraCalibration(time_ns, 2, 2, np.eye(3)))


@pytest.fixture
def position_file(tmp_path: Path) -> PositionFile:
    return PositionFile(tmp_path / "state" / "position.json", "today")


@pytest.fixture
def lossless(position_file: PositionFile) -> Callable[[int], Camera]:
    def make(count: int) -> Camera:
        first = position_file.read().sequence + 1
        outlet = Outlet()
        return Camera(
            LosslessDelivery(FrameWindow(2, SERVICES, 2.0, first), position_file, outlet), outlet, first, count
        )

    return make


@pytest.fixture
def realtime(position_file: PositionFile) -> Callable[[int], Camera]:
    def make(count: int) -> Camera:
        first = position_file.read().sequence + 1
        outlet = Outlet()
        window = FrameWindow(1, SERVICES, 2.0)
        return Camera(RealtimeDelivery(window, position_file, outlet, Pacing()), outlet, first, count)

    return make


def test_lossless_keeps_the_window_and_ends_when_all_is_answered(lossless: Callable[[int], Camera]) -> None:
    camera = lossless(3)
    assert [camera.step(0.0) for _ in range(3)] == [0.0, 2.0, 2.0]
    assert camera.outlet.sent == [0, 1]
    camera.delivery.answered("slam", 0)
    camera.step(0.0)
    assert camera.outlet.sent == [0, 1]
    camera.delivery.answered("recorder", 0)
    for _ in range(3):
        camera.step(0.0)
    assert (camera.outlet.sent, camera.delivery.done) == ([0, 1, 2], 0)
    camera.answer(2)
    camera.step(0.0)
    assert camera.outlet.sent == [0, 1, 2]
    camera.answer(1)
    camera.step(0.0)
    assert camera.outlet.parcels[-1] == Parcel(3, 2 * STEP_NS + 1, ())
    assert not camera.delivery.ended
    camera.answer(3)
    assert (camera.delivery.ended, camera.delivery.done) == (True, 2)


def test_lossless_sends_the_same_again_until_it_is_answered(lossless: Callable[[int], Camera]) -> None:
    camera = lossless(1)
    camera.step(0.0)
    assert camera.step(1.5) == pytest.approx(0.5)
    assert camera.outlet.sent == [0]
    camera.step(2.0)
    assert camera.outlet.parcels == [camera.outlet.parcels[0]] * 2
    assert camera.delivery.waiting_for() == "recorder 0-0, slam 0-0"
    camera.delivery.service_came(2.5)
    camera.step(2.5)
    assert (camera.outlet.sent, camera.delivery.sent_again) == ([0, 0, 0], 2)
    camera.answer(0)
    camera.step(3.0)
    camera.step(5.0)
    assert camera.outlet.sent == [0, 0, 0, 1, 1]
    assert not camera.delivery.ended


def test_lossless_does_not_count_the_time_a_frame_takes_to_render(lossless: Callable[[int], Camera]) -> None:
    camera = lossless(2)
    camera.delivery.offer(_frame(0), 5.0)
    assert camera.delivery.step(5.0) == 0.0
    camera.delivery.offer(_frame(1), 6.9)
    assert camera.delivery.step(6.9) == pytest.approx(0.1)
    assert camera.outlet.sent == [0, 1]


def test_lossless_goes_on_where_a_killed_one_was(lossless: Callable[[int], Camera]) -> None:
    killed = lossless(5)
    for sequence in range(3):
        killed.step(0.0)
        killed.answer(sequence)
    killed.step(0.0)
    killed.step(0.0)
    resumed = lossless(5)
    assert resumed.delivery.done == 2
    resumed.step(0.0)
    resumed.step(0.0)
    assert resumed.outlet.sent == [3, 4]
    resumed.answer(3)
    resumed.answer(4)
    killed_before_the_end = lossless(5)
    killed_before_the_end.step(0.0)
    assert killed_before_the_end.outlet.parcels == [Parcel(5, 4 * STEP_NS + 1, ())]
    killed_before_the_end.answer(5)
    assert killed_before_the_end.delivery.ended
    assert lossless(5).delivery.ended


def test_realtime_paces_and_waits_for_nobody(realtime: Callable[[int], Camera]) -> None:
    camera = realtime(3)
    assert camera.step(50.0) == 0.0
    assert camera.step(50.0) == pytest.approx(0.1)
    assert camera.step(50.06) == pytest.approx(0.04)
    assert camera.outlet.sent == [0]
    camera.step(50.1)
    camera.step(50.2)
    assert (camera.outlet.sent, camera.delivery.done) == ([0, 1, 2], 2)
    camera.step(50.2)
    assert camera.outlet.parcels[-1] == Parcel(3, 2 * STEP_NS + 1, ())
    camera.step(52.5)
    assert (camera.outlet.sent, camera.delivery.sent_again) == ([0, 1, 2, 3, 3], 1)
    camera.delivery.answered("slam", 3)
    assert (camera.delivery.ended, camera.delivery.waiting_for()) == (False, "recorder")
    camera.answer(3)
    assert camera.delivery.ended


def test_realtime_gives_up_on_the_end(realtime: Callable[[int], Camera], position_file: PositionFile) -> None:
    camera = realtime(1)
    camera.step(0.0)
    camera.step(0.0)
    camera.step(29.0)
    assert not camera.delivery.ended
    camera.step(31.0)
    assert camera.delivery.ended
    assert position_file.read() == Position(0, 0, ended=True)


def test_realtime_goes_on_behind_the_last_frame_sent(realtime: Callable[[int], Camera]) -> None:
    realtime(3).step(0.0)
    resumed = realtime(3)
    resumed.step(7.0)
    assert resumed.outlet.parcels == [Parcel(1, STEP_NS, ())]


def test_pacing_does_not_make_up_for_a_long_stop() -> None:
    pacing = Pacing()
    assert pacing.wait_s(0, 10.0) == 0.0
    assert pacing.wait_s(STEP_NS, 10.15) == 0.0
    assert pacing.wait_s(2 * STEP_NS, 10.15) == pytest.approx(0.05)
    assert pacing.wait_s(3 * STEP_NS, 20.0) == 0.0
    assert pacing.wait_s(4 * STEP_NS, 20.0) == pytest.approx(0.1)


def test_position_of_another_session_does_not_count(tmp_path: Path) -> None:
    path = tmp_path / "state" / "position.json"
    PositionFile(path, "yesterday").save(Position(7, 700))
    assert PositionFile(path, "yesterday").read() == Position(7, 700)
    assert PositionFile(path, "today").read() == Position(-1, -1)
    path.write_text("{")
    with pytest.raises(ResourceError, match=r"position\.json is damaged"):
        PositionFile(path, "today").read()
    with pytest.raises(ResourceError, match="cannot be written"):
        PositionFile(path / "below", "today").save(Position())
