# SPDX-License-Identifier: Apache-2.0
"""Downloads from a server of the test's own, that can cut off, lie and refuse."""

import hashlib
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from services.runtime.errors import InputError, ResourceError
from services.weights.download import download

CONTENT = bytes(range(256)) * 2000
SHA256 = hashlib.sha256(CONTENT).hexdigest()


class Server(ThreadingHTTPServer):
    """Serves CONTENT; `cut` sends only so many bytes of it once, `ranges` says whether it can go on from a place."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.cut: int | None = None
        self.ranges = True
        self.asked: list[tuple[str, str | None]] = []

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}/model.pth"


class Handler(BaseHTTPRequestHandler):
    server: Server

    def do_GET(self) -> None:
        wanted = self.headers.get("Range")
        self.server.asked.append((self.path, wanted))
        if not self.path.endswith("model.pth"):
            self.send_error(404, "Not Found")
            return
        start = int(wanted.removeprefix("bytes=").removesuffix("-")) if wanted and self.server.ranges else 0
        if start >= len(CONTENT):
            self.send_error(416, "Range Not Satisfiable")
            return
        self.send_response(206 if start else 200)
        self.send_header("Content-Length", str(len(CONTENT) - start))
        self.end_headers()
        end, self.server.cut = self.server.cut, None
        self.wfile.write(CONTENT[start:end])

    def log_message(self, *_: object) -> None:
        """Tests print nothing."""


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Iterator[Server]:
    for name in ("http_proxy", "HTTP_PROXY", "all_proxy", "ALL_PROXY"):
        monkeypatch.delenv(name, raising=False)
    with Server() as server:
        threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True).start()
        yield server
        server.shutdown()


def test_a_whole_file_arrives_with_progress(server: Server, tmp_path: Path) -> None:
    seen: list[tuple[int, int | None]] = []
    digest = download(server.url, tmp_path / "new" / "m.pth", SHA256[:8], lambda *at: seen.append(at))
    assert digest == SHA256
    assert (tmp_path / "new" / "m.pth").read_bytes() == CONTENT
    assert seen[-1] == (len(CONTENT), len(CONTENT))
    assert [path.name for path in (tmp_path / "new").iterdir()] == ["m.pth"]


def test_goes_on_where_it_was_cut_off(server: Server, tmp_path: Path) -> None:
    server.cut = 100_000
    with pytest.raises(ResourceError, match=r"cut off after 100000 of 512000 bytes"):
        download(server.url, tmp_path / "m.pth", SHA256[:8])
    assert not (tmp_path / "m.pth").exists()
    download(server.url, tmp_path / "m.pth", SHA256[:8])
    assert (tmp_path / "m.pth").read_bytes() == CONTENT
    assert [wanted for _, wanted in server.asked] == [None, "bytes=100000-"]


def test_starts_again_where_the_server_cannot_go_on(server: Server, tmp_path: Path) -> None:
    (tmp_path / "m.pth.part").write_bytes(b"x" * 1000)
    server.ranges = False
    download(server.url, tmp_path / "m.pth", SHA256[:8])
    assert (tmp_path / "m.pth").read_bytes() == CONTENT


def test_a_part_that_is_whole_already_is_only_checked(server: Server, tmp_path: Path) -> None:
    (tmp_path / "m.pth.part").write_bytes(CONTENT)
    download(server.url, tmp_path / "m.pth", SHA256[:8])
    assert (tmp_path / "m.pth").read_bytes() == CONTENT


def test_another_checksum_is_refused_and_removed(server: Server, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=f"begins with {SHA256[:8]}, expected 00000000"):
        download(server.url, tmp_path / "m.pth", "00000000")
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_is_not_there_is_named(server: Server, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"other\.bin: the server answers 404 Not Found"):
        download(server.url.replace("model.pth", "other.bin"), tmp_path / "m.pth", SHA256[:8])


def test_offline_is_one_line_that_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(ResourceError, match=r"nowhere\.invalid cannot be reached \(.*\): get .* weights import FILE"):
        download("http://nowhere.invalid/m.pth", tmp_path / "m.pth", SHA256[:8])


def test_goes_through_a_proxy(server: Server, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("http_proxy", f"http://127.0.0.1:{server.server_port}")
    download("http://nowhere.invalid/model.pth", tmp_path / "m.pth", SHA256[:8])
    assert server.asked == [("http://nowhere.invalid/model.pth", None)]
