# SPDX-License-Identifier: Apache-2.0
"""The camera service on a bus within the process."""

import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from schemas import topics
from schemas.codec import decode, encode
from schemas.records import FrameAnswer
from services.camera.configured_delivery import require_realtime
from services.camera.configured_source import open_configured_source
from services.camera.service import CameraService
from services.camera.sources.live.live_camera import LiveCamera
from services.camera.sources.live.opencv_camera import assumed_calibration
from services.runtime.bus import Message
from services.runtime.config import Config
from services.runtime.config.camera import CameraConfig
from services.runtime.config.delivery import DeliveryConfig
from services.runtime.config.run import RunConfig
from services.runtime.errors import InputError
from services.runtime.fake_bus import FakeBus, FakeNetwork
from tests.unit.camera.scripted_capture import Cameras, ScriptedCapture

SESSION = "test"


@dataclass
class Host:
    """What the camera sees of its process."""

    stopping: threading.Event = field(default_factory=threading.Event)
    state: str = "starting"
    sequence: int = -1


class Others:
    """All services that the camera counts on: they hear everything and answer every frame.

    `deaf` frames are not answered the first time.
    """

    def __init__(self, network: FakeNetwork, deaf: tuple[int, ...] = ()) -> None:
        self.heard: list[Message] = []
        self._deaf = set(deaf)
        self._bus = FakeBus(network)
        wanted = [topic for topic in topics.TOPICS if topic.producer == "camera"]
        self._queue = self._bus.subscribe(wanted)
        for name in topics.END.consumers:
            self._bus.declare_alive(name)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def _serve(self) -> None:
        while not self._over.is_set():
            message = self._queue.receive(0.05)
            if message is None:
                continue
            self.heard.append(message)
            if message.topic in (topics.IMAGE, topics.END):
                self._answer(message)

    def _answer(self, message: Message) -> None:
        sequence = message.envelope.sequence
        if sequence in self._deaf:
            self._deaf.remove(sequence)
            return
        for name in topics.ANSWERING_SERVICES:
            answer = encode(topics.ANSWER, FrameAnswer(message.envelope.timestamp_ns, name))
            self._bus.publish(topics.ANSWER, answer, message.envelope, name)

    def of(self, topic: topics.Topic) -> list[tuple[int, Any]]:
        return [(m.envelope.sequence, decode(topic, m.payload)) for m in self.heard if m.topic is topic]

    def close(self) -> None:
        self._over.set()
        self._thread.join()
        self._bus.close()


@pytest.fixture
def network() -> FakeNetwork:
    return FakeNetwork()


@pytest.fixture
def others(network: FakeNetwork) -> Iterator[Others]:
    services = Others(network)
    yield services
    services.close()


def _config(tmp_path: Path, given: Path, **delivery: Any) -> Config:
    config = Config()
    config.run = RunConfig(out=tmp_path / "out", session=SESSION)
    config.camera = CameraConfig(input=str(given))
    config.delivery = DeliveryConfig.model_validate(delivery)
    return config


def _run(network: FakeNetwork, config: Config) -> Host:
    host = Host()
    with FakeBus(network) as bus:
        CameraService(open_configured_source(config), bus, config).run(host)
    return host


def test_every_frame_goes_out_once_and_whole(
    network: FakeNetwork, others: Others, tmp_path: Path, stereo: Path
) -> None:
    host = _run(network, _config(tmp_path, stereo))
    assert (host.state, host.sequence) == ("done", 2)
    keys = [message.topic.key for message in others.heard]
    once = ["camera/manifest", "camera/calibration", "camera/image", "camera/calibration_right", "camera/image_right"]
    assert keys == once * 3 + ["camera/end"]
    for sequence, manifest in others.of(topics.MANIFEST):
        assert list(manifest.topics) == once[1:]
        assert (manifest.frame_name, manifest.frame_count) == (f"{sequence:06d}", 3)
        assert manifest.rate_hz == pytest.approx(1 / 0.1036)
    assert [(sequence, int(image.pixels[0, 0])) for sequence, image in others.of(topics.IMAGE)] == [
        (0, 0),
        (1, 10),
        (2, 20),
    ]
    ((sequence, end),) = others.of(topics.END)
    assert (sequence, end.frame_count, end.timestamp_ns) == (3, 3, 207_200_001)
    assert {message.envelope.session for message in others.heard} == {SESSION}
    for message in others.heard:
        assert decode(message.topic, message.payload).timestamp_ns == message.envelope.timestamp_ns


def test_an_unanswered_frame_is_sent_again_with_the_same_bytes(
    network: FakeNetwork, tmp_path: Path, kitti: Path
) -> None:
    others = Others(network, deaf=(1, 3))
    try:
        host = _run(network, _config(tmp_path, kitti, resend_after_s=0.2))
    finally:
        others.close()
    assert host.state == "done"
    second = [message for message in others.heard if message.envelope.sequence == 1]
    assert len(second) == 2 * 3
    assert second[:3] == second[3:]
    assert len(others.of(topics.END)) == 2


def test_it_waits_for_the_others_before_the_first_frame(network: FakeNetwork, tmp_path: Path, kitti: Path) -> None:
    ear = FakeBus(network)
    queue = ear.subscribe([topics.MANIFEST])
    host = Host()
    config = _config(tmp_path, kitti)
    with FakeBus(network) as bus:
        camera = CameraService(open_configured_source(config), bus, config)
        thread = threading.Thread(target=camera.run, args=(host,))
        thread.start()
        assert queue.receive(0.3) is None
        others = Others(network)
        thread.join(timeout=20)
    others.close()
    assert not thread.is_alive()
    assert host.state == "done"
    assert queue.receive(0.0) is not None
    ear.close()


def test_it_stops_when_it_is_told_and_goes_on_from_there(network: FakeNetwork, tmp_path: Path, kitti: Path) -> None:
    stopped = Host()
    stopped.stopping.set()
    config = _config(tmp_path, kitti)
    with FakeBus(network) as bus:
        CameraService(open_configured_source(config), bus, config).run(stopped)
    assert (stopped.state, stopped.sequence) == ("starting", -1)
    others = Others(network)
    try:
        first = _run(network, config)
        heard = len(others.heard)
        again = _run(network, config)
    finally:
        others.close()
    assert (first.state, again.state, again.sequence) == ("done", "done", 2)
    assert len(others.heard) == heard


def test_a_broken_frame_ends_the_input_before_it(
    network: FakeNetwork, others: Others, tmp_path: Path, kitti: Path
) -> None:
    path = kitti / "image_0" / "000002.png"
    path.write_bytes(path.read_bytes()[:40])
    with pytest.raises(InputError, match=r"000002\.png: not a readable image"):
        _run(network, _config(tmp_path, kitti))
    ((sequence, end),) = others.of(topics.END)
    assert (sequence, end.frame_count) == (2, 2)
    assert [sequence for sequence, _ in others.of(topics.MANIFEST)] == [0, 1]


def test_a_broken_first_frame_sends_nothing(network: FakeNetwork, others: Others, tmp_path: Path, kitti: Path) -> None:
    path = kitti / "image_0" / "000000.png"
    path.write_bytes(path.read_bytes()[:40])
    with pytest.raises(InputError, match=r"000000\.png: not a readable image"):
        _run(network, _config(tmp_path, kitti))
    assert others.heard == []


def test_realtime_sends_at_the_captured_pace(
    network: FakeNetwork, others: Others, tmp_path: Path, image_folder: Path
) -> None:
    np.savetxt(image_folder / "times.txt", [0.0, 0.02, 0.04], fmt="%.2f")
    host = _run(network, _config(tmp_path, image_folder, mode="realtime"))
    assert (host.state, host.sequence) == ("done", 2)
    assert [sequence for sequence, _ in others.of(topics.IMAGE)] == [0, 1, 2]
    assert [sequence for sequence, _ in others.of(topics.END)] == [3]


def test_another_session_answers_for_nobody(network: FakeNetwork, tmp_path: Path, kitti: Path) -> None:
    config = _config(tmp_path, kitti, window=1)
    host = Host()
    stranger = FakeBus(network)
    queue = stranger.subscribe([topics.IMAGE])
    for name in topics.END.consumers:
        stranger.declare_alive(name)
    with FakeBus(network) as bus:
        camera = CameraService(open_configured_source(config), bus, config)
        thread = threading.Thread(target=camera.run, args=(host,))
        thread.start()
        message = queue.receive(10.0)
        assert message is not None
        for name in topics.ANSWERING_SERVICES:
            answer = encode(topics.ANSWER, FrameAnswer(0, name))
            stranger.publish(topics.ANSWER, answer, message.envelope._replace(session="yesterday"), name)
        assert queue.receive(0.3) is None
        host.stopping.set()
        thread.join(timeout=20)
    assert host.sequence == -1
    stranger.close()


def test_colour_travels_as_it_is(network: FakeNetwork, others: Others, tmp_path: Path, kitti: Path) -> None:
    pixels = np.random.default_rng(3).integers(0, 256, (24, 32, 3), dtype=np.uint8)
    for index in range(3):
        cv2.imwrite(str(kitti / "image_0" / f"{index:06d}.png"), pixels)
    _run(network, _config(tmp_path, kitti))
    np.testing.assert_array_equal(others.of(topics.IMAGE)[0][1].pixels, pixels)


def _live_config(tmp_path: Path, **delivery: Any) -> Config:
    config = _config(tmp_path, Path("unused"), **delivery)
    config.camera = CameraConfig(input="rtsp://user:secret@camera/stream")
    return config


def test_a_live_camera_is_sent_as_it_comes_and_stops_while_it_is_gone(
    network: FakeNetwork, others: Others, tmp_path: Path
) -> None:
    config = _live_config(tmp_path, mode="realtime")
    capture = ScriptedCapture()
    capture.show(1)
    host = Host()
    ear = FakeBus(network)
    images = ear.subscribe([topics.IMAGE])
    with FakeBus(network) as bus:
        source = LiveCamera("camera test", Cameras(capture), assumed_calibration, backoff_s=(0.01,))
        thread = threading.Thread(target=CameraService(source, bus, config).run, args=(host,))
        thread.start()
        times_ns = []
        for value in (2, 3):
            capture.show(value)
            message = images.receive(10.0)
            assert message is not None
            image = decode(topics.IMAGE, message.payload)
            assert int(image.pixels[0, 0, 0]) == value
            times_ns.append(image.timestamp_ns)
        capture.show(None)
        host.stopping.set()
        thread.join(timeout=20)
    ear.close()
    assert not thread.is_alive()
    assert times_ns[0] < times_ns[1]
    assert others.of(topics.END) == []


def test_a_live_camera_cannot_be_lossless(network: FakeNetwork, tmp_path: Path) -> None:
    config = _live_config(tmp_path, mode="lossless")
    with pytest.raises(InputError, match=r"rtsp://\.\.\.@camera/stream: a live camera cannot repeat a frame") as caught:
        require_realtime(config)
    assert "secret" not in str(caught.value)
    require_realtime(_live_config(tmp_path, mode="realtime"))
