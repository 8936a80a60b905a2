# SPDX-License-Identifier: Apache-2.0
"""Live cameras: the newest frame wins, a camera that goes away comes back, and nobody waits for one for ever."""

import threading
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from services.camera.sources.live.live_address import is_live, without_credentials
from services.camera.sources.live.live_camera import LiveCamera
from services.camera.sources.live.opencv_camera import assumed_calibration, open_live_camera
from services.camera.sources.source import SourceFrame
from services.runtime.errors import InputError
from tests.unit.camera.scripted_capture import BROKEN, SIZE, Cameras, ScriptedCapture


def _live(cameras: Cameras) -> LiveCamera:
    return LiveCamera("camera test", cameras, assumed_calibration, backoff_s=(0.01, 0.02))


def _value(frame: SourceFrame | None) -> int:
    assert frame is not None
    return int(frame.image.pixels[0, 0, 0])


def test_the_newest_frame_wins_and_each_is_given_once() -> None:
    capture = ScriptedCapture()
    capture.show(1)
    camera = _live(Cameras(capture))
    assert (camera.frame_count, camera.rate_hz) == (-1, 25)
    for value in (2, 3, 4):
        capture.show(value)
    capture.wait_until_seen()
    first = camera.frame(7)
    assert (_value(first), first.name if first else "") == (4, "000007")
    capture.show(5)
    second = camera.frame(8)
    assert _value(second) == 5
    assert first is not None
    assert second is not None
    assert second.timestamp_ns > first.timestamp_ns
    assert second.calibration.timestamp_ns == second.timestamp_ns
    capture.release()
    camera.close()


def test_a_camera_that_goes_away_comes_back(caplog: pytest.LogCaptureFixture) -> None:
    before, broken, after = ScriptedCapture(), ScriptedCapture(), ScriptedCapture()
    before.show(1)
    before.show(2)
    cameras = Cameras(before, None, broken, None, after)
    camera = _live(cameras)
    first = camera.frame(0)
    assert _value(first) == 2
    before.show(None)
    broken.show(None)
    after.show(3)
    later = camera.frame(1)
    assert _value(later) == 3
    assert cameras.opened == 5
    assert before.released
    assert broken.released
    assert first is not None
    assert later is not None
    assert later.timestamp_ns > first.timestamp_ns
    after.release()
    camera.close()
    assert [record.getMessage() for record in caplog.records][:5] == ["camera_is_lost"] * 4 + ["camera_is_back"]


def test_a_broken_frame_is_left_out_and_the_camera_kept() -> None:
    capture = ScriptedCapture()
    capture.show(1)
    cameras = Cameras(capture)
    camera = _live(cameras)
    capture.show(BROKEN)
    capture.show(3)
    assert _value(camera.frame(0)) == 3
    assert cameras.opened == 1
    capture.release()
    camera.close()


def test_closing_frees_whoever_waits_for_a_camera_that_is_gone() -> None:
    capture = ScriptedCapture()
    capture.show(1)
    capture.show(None)
    cameras = Cameras(capture)
    camera = _live(cameras)
    got: list[SourceFrame | None] = []
    waiting = threading.Thread(target=lambda: got.append(camera.frame(0)))
    waiting.start()
    camera.close()
    waiting.join(timeout=10)
    assert got == [None]
    assert camera.frame(1) is None
    camera.close()


def test_frames_of_another_size_are_refused() -> None:
    capture = ScriptedCapture()
    capture.show(1)
    camera = _live(Cameras(capture))
    capture.show(2, size=(32, 24))
    with pytest.raises(InputError, match="camera test: 32x24 px now, expected 64x48"):
        camera.frame(0)
    capture.release()
    camera.close()


def test_a_camera_that_gives_nothing_is_one_line(tmp_path: Path) -> None:
    silent = ScriptedCapture()
    silent.show(None)
    for cameras in (Cameras(None), Cameras(silent)):
        with pytest.raises(InputError, match="camera test: gives no frame, expected a camera that can be reached"):
            _live(cameras)
    assert silent.released
    with pytest.raises(InputError, match="camera /dev/video97: gives no frame"):
        open_live_camera("/dev/video97")


@pytest.mark.parametrize(
    ("given", "live"),
    [
        ("0", True),
        ("/dev/video2", True),
        ("rtsp://user:secret@10.0.0.7:554/stream1", True),
        ("http://127.0.0.1:8080/video", True),
        ("/data/drive.mp4", False),
        ("simulator", False),
        ("./0", False),
        ("2011_09_26", False),
    ],
)
def test_addresses_of_cameras(given: str, live: bool) -> None:
    assert is_live(given) is live
    assert "secret" not in without_credentials(given)


class _Stream(BaseHTTPRequestHandler):
    """MJPEG over HTTP; every connection ends after a few frames, as cheap cameras do."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
        self.end_headers()
        self.server.connections += 1  # type: ignore[attr-defined]
        image = np.full((*SIZE[::-1], 3), 40 * self.server.connections, np.uint8)  # type: ignore[attr-defined]
        jpeg = cv2.imencode(".jpg", image)[1].tobytes()
        head = f"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {len(jpeg)}\r\n\r\n".encode()
        for _ in range(8):
            self.wfile.write(head + jpeg + b"\r\n")

    def log_message(self, format: str, *arguments: Any) -> None:  # noqa: A002
        """Nothing."""


@pytest.fixture
def stream() -> Iterator[Callable[[], str]]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), _Stream)
    server.connections = 0  # type: ignore[attr-defined]
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield lambda: f"http://127.0.0.1:{server.server_address[1]}/video.mjpg"
    server.shutdown()
    thread.join()
    server.server_close()


def test_an_http_camera_is_read_over_a_broken_connection(stream: Callable[[], str], tmp_path: Path) -> None:
    calibration = tmp_path / "calibration.toml"
    calibration.write_text("fx = 70.0\nfy = 70.0\ncx = 32.0\ncy = 24.0\nwidth = 64\nheight = 48\n")
    camera = open_live_camera(stream(), calibration=calibration)
    frames: list[SourceFrame] = []
    while len({_value(frame) // 40 for frame in frames}) < 2:
        frame = camera.frame(len(frames))
        assert frame is not None
        frames.append(frame)
    times_ns = [frame.timestamp_ns for frame in frames]
    assert times_ns == sorted(set(times_ns))
    assert frames[0].calibration.intrinsics[0, 0] == 70
    assert camera.notes == ()
    camera.close()
    guessed = open_live_camera(stream())
    assert any("a horizontal field of view of 60 degrees is assumed" in note for note in guessed.notes)
    guessed.close()
    calibration.write_text(calibration.read_text().replace("48", "40"))
    with pytest.raises(InputError, match=r"64x48 px, expected 64x40 as in .*calibration\.toml"):
        open_live_camera(stream(), calibration=calibration)
