# SPDX-License-Identifier: Apache-2.0
"""The gateway as a real server: many who ask at once while the map grows, and requests that mean it ill."""

import http.client
import json
import socket
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from services.mapstore.base_pose import BasePose
from services.mapstore.density import DynamicDensity
from services.mapstore.gateway.live_map import LiveMap
from services.mapstore.gateway.server import Gateway
from services.mapstore.map_state import MapState
from services.runtime.config.mapstore import OPTICAL_TO_REP103, MapstoreConfig
from services.runtime.errors import ResourceError
from tests.unit.mapstore.street_map import drive, state_of

OPTIONS = MapstoreConfig(http_port=0)


def live_map(state: MapState) -> LiveMap:
    return LiveMap(state.view(), DynamicDensity(), BasePose(np.array(OPTICAL_TO_REP103)))


@pytest.fixture
def gateway() -> Iterator[Gateway]:
    gateway = Gateway(OPTIONS, live_map(state_of(11)))
    yield gateway
    gateway.close()


def connect(gateway: Gateway) -> http.client.HTTPConnection:
    return http.client.HTTPConnection(gateway.url.removeprefix("http://"), timeout=20)


def test_nobody_who_asks_while_the_map_grows_is_failed() -> None:
    state = MapState()
    live = live_map(state)
    gateway = Gateway(OPTIONS, live)
    over = threading.Event()

    def ask(path: str) -> list[int]:
        connection, sequences = connect(gateway), []
        while not over.is_set() or not sequences:
            connection.request("GET", path)
            answer = connection.getresponse()
            content = answer.read()
            assert answer.status == 200, content
            if answer.headers["content-type"] == "application/json":
                sequences.append(json.loads(content)["sequence"])
            else:
                sequences.append(-1)
        connection.close()
        return sequences

    paths = [
        "/density?pose=current",
        "/density?pose=9,0,0&window=all",
        "/pose",
        "/objects",
        "/map/snapshot",
        "/map/top_view",
    ]
    with ThreadPoolExecutor(len(paths)) as pool:
        asking = [pool.submit(ask, path) for path in paths]
        for sequence, (frame, update) in enumerate(drive(120)):
            state.add_frame(sequence, frame)
            state.apply(update)
            live.show(state.view())
        over.set()
        for answers in asking:
            assert answers.result() == sorted(answers.result()), "time went backwards"
    gateway.close()


def test_an_answer_on_a_kept_connection_does_not_wait_for_an_acknowledgement(gateway: Gateway) -> None:
    assert gateway._socket.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY) == 1


def test_two_gigabytes_are_refused_before_they_are_sent(gateway: Gateway) -> None:
    connection = connect(gateway)
    connection.putrequest("POST", "/density")
    connection.putheader("Content-Length", str(2 << 30))
    connection.endheaders()
    connection.send(b"0" * 100_000)
    answer = connection.getresponse()
    assert answer.status == 413
    assert json.loads(answer.read()) == {"detail": f"request body of {2 << 30} bytes: expected at most 1024"}
    connection.close()
    again = connect(gateway)
    again.request("GET", "/healthz")
    assert again.getresponse().status == 200
    again.close()


@pytest.mark.parametrize(
    "request_bytes",
    [
        b"GET /density HTTP/1.1\r\nHost: x\r\nContent-Length: many\r\n\r\n",
        b"GET /density HTTP/1.1\r\nHost: x\r\nContent-Length: -5\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
        b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\nHost: x\r\n\r\n",
    ],
    ids=["content-length-many", "content-length-negative", "tls", "url-of-100-kB"],
)
def test_what_is_no_http_is_refused_and_the_gateway_goes_on(gateway: Gateway, request_bytes: bytes) -> None:
    host, port = gateway.url.removeprefix("http://").split(":")
    with socket.create_connection((host, int(port)), timeout=20) as raw:
        raw.sendall(request_bytes)
        raw.shutdown(socket.SHUT_WR)
        assert raw.recv(100).startswith(b"HTTP/1.1 4")
    connection = connect(gateway)
    connection.request("GET", "/healthz")
    assert connection.getresponse().status == 200
    connection.close()


def test_a_port_in_use_is_one_line_with_exit_code_2(gateway: Gateway) -> None:
    port = int(gateway.url.rsplit(":", 1)[1])
    with pytest.raises(ResourceError, match=f"port {port} on 127.0.0.1 is in use; expected a free one") as error:
        Gateway(MapstoreConfig(http_port=port), live_map(MapState()))
    assert error.value.exit_code == 2


def test_the_port_is_free_again_once_closed() -> None:
    first = Gateway(OPTIONS, live_map(MapState()))
    port = int(first.url.rsplit(":", 1)[1])
    connection = connect(first)
    connection.request("GET", "/healthz")
    connection.getresponse().read()
    first.close()
    connection.close()
    Gateway(MapstoreConfig(http_port=port), live_map(MapState())).close()
