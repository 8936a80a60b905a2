# SPDX-License-Identifier: Apache-2.0
"""Both ways to deliver, without a bus and without a clock."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from schemas.records import CameraCalibration, Image
from services.camera.lossless import LosslessDelivery
from services.camera.outlet import NextFrame, Parcel
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


def _frames(first: int, count: int) -> NextFrame:
    pixels = np.zeros((2, 2), dtype=np.uint8)
    times = [index * STEP_NS for index in range(first, count)]
    frames = [
        SourceFrame(str(time), time, Image(time, pixels), CameraCalibration(time, 2, 2, np.eye(3))) for time in times
    ]
    return iter([*frames, None, None]).__next__


@pytest.fixture
def position_file(tmp_path: Path) -> PositionFile:
    return PositionFile(tmp_path / "state" / "position.json", "today")


@pytest.fixture
def lossless(position_file: PositionFile) -> Callable[..., tuple[LosslessDelivery, Outlet]]:
    def make(count: int = 5, window: int = 2) -> tuple[LosslessDelivery, Outlet]:
        first = position_file.read().sequence + 1
        outlet = Outlet()
        frame_window = FrameWindow(window, SERVICES, 2.0, first)
        return LosslessDelivery(_frames(first, count), frame_window, position_file, outlet), outlet

    return make


def _answer(delivery: LosslessDelivery | RealtimeDelivery, sequence: int) -> None:
    for service in SERVICES:
        delivery.answered(service, sequence)


def test_lossless_keeps_the_window_and_ends_when_all_is_answered(
    lossless: Callable[..., tuple[LosslessDelivery, Outlet]],
) -> None:
    delivery, outlet = lossless(count=3)
    assert [delivery.step(0.0) for _ in range(4)] == [0.0, 2.0, 2.0, 2.0]
    assert outlet.sent == [0, 1]
    delivery.answered("slam", 0)
    delivery.step(0.0)
    assert outlet.sent == [0, 1]
    delivery.answered("recorder", 0)
    for _ in range(3):
        delivery.step(0.0)
    assert (outlet.sent, delivery.done) == ([0, 1, 2], 0)
    _answer(delivery, 2)
    delivery.step(0.0)
    assert outlet.sent == [0, 1, 2]
    _answer(delivery, 1)
    delivery.step(0.0)
    assert outlet.parcels[-1] == Parcel(3, 2 * STEP_NS + 1, ())
    assert not delivery.ended
    _answer(delivery, 3)
    assert (delivery.ended, delivery.done) == (True, 2)


def test_lossless_sends_the_same_again_until_it_is_answered(
    lossless: Callable[..., tuple[LosslessDelivery, Outlet]],
) -> None:
    delivery, outlet = lossless(count=1)
    delivery.step(0.0)
    assert delivery.step(1.5) == pytest.approx(0.5)
    assert outlet.sent == [0]
    delivery.step(2.0)
    assert outlet.parcels == [outlet.parcels[0]] * 2
    assert delivery.waiting_for() == "recorder 0-0, slam 0-0"
    delivery.service_came(2.5)
    delivery.step(2.5)
    assert (outlet.sent, delivery.sent_again) == ([0, 0, 0], 2)
    _answer(delivery, 0)
    delivery.step(3.0)
    delivery.step(5.0)
    assert outlet.sent == [0, 0, 0, 1, 1]
    assert not delivery.ended


def test_lossless_goes_on_where_a_killed_one_was(lossless: Callable[..., tuple[LosslessDelivery, Outlet]]) -> None:
    delivery, _ = lossless(count=5)
    for sequence in range(3):
        delivery.step(0.0)
        _answer(delivery, sequence)
    delivery.step(0.0)
    delivery.step(0.0)
    resumed, outlet = lossless(count=5)
    assert resumed.done == 2
    resumed.step(0.0)
    resumed.step(0.0)
    assert outlet.sent == [3, 4]
    _answer(resumed, 3)
    _answer(resumed, 4)
    killed_before_the_end, outlet = lossless(count=5)
    killed_before_the_end.step(0.0)
    assert outlet.parcels == [Parcel(5, 4 * STEP_NS + 1, ())]
    _answer(killed_before_the_end, 5)
    assert killed_before_the_end.ended
    assert lossless(count=5)[0].ended


def test_realtime_paces_and_waits_for_nobody(position_file: PositionFile) -> None:
    outlet = Outlet()
    delivery = RealtimeDelivery(_frames(0, 3), FrameWindow(1, SERVICES, 2.0), position_file, outlet)
    assert delivery.step(50.0) == 0.0
    assert delivery.step(50.0) == pytest.approx(0.1)
    assert delivery.step(50.06) == pytest.approx(0.04)
    assert outlet.sent == [0]
    delivery.step(50.1)
    delivery.step(50.2)
    assert (outlet.sent, delivery.done) == ([0, 1, 2], 2)
    delivery.step(50.2)
    assert outlet.parcels[-1] == Parcel(3, 2 * STEP_NS + 1, ())
    delivery.step(52.5)
    assert (outlet.sent, delivery.sent_again) == ([0, 1, 2, 3, 3], 1)
    delivery.answered("slam", 3)
    assert (delivery.ended, delivery.waiting_for()) == (False, "recorder")
    _answer(delivery, 3)
    assert delivery.ended


def test_realtime_gives_up_on_the_end(position_file: PositionFile) -> None:
    delivery = RealtimeDelivery(_frames(0, 1), FrameWindow(1, SERVICES, 2.0), position_file, Outlet())
    delivery.step(0.0)
    delivery.step(0.0)
    delivery.step(29.0)
    assert not delivery.ended
    delivery.step(31.0)
    assert delivery.ended
    assert position_file.read() == Position(0, 0, ended=True)


def test_realtime_goes_on_behind_the_last_frame_sent(position_file: PositionFile) -> None:
    first = RealtimeDelivery(_frames(0, 3), FrameWindow(1, SERVICES, 2.0), position_file, Outlet())
    first.step(0.0)
    outlet = Outlet()
    RealtimeDelivery(_frames(1, 3), FrameWindow(1, SERVICES, 2.0), position_file, outlet).step(7.0)
    assert outlet.parcels == [Parcel(1, STEP_NS, ())]


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
