# SPDX-License-Identifier: Apache-2.0
"""The service in its loop: each frame once, an answer to each, and the same answer to a repeated one."""

import urllib.request
from pathlib import Path

import pytest

from schemas import topics
from schemas.codec import decode
from schemas.records import DensityLevel
from services.mapstore.export import load_view
from services.mapstore.service import MapstoreService
from services.runtime.errors import InputError, ResourceError
from tests.unit.mapstore.mapstore_process import SESSION, FedMapstore, config_of


def test_every_frame_is_answered_with_the_density_at_its_pose(tmp_path: Path) -> None:
    fed = FedMapstore(config_of(tmp_path, serve_http=False, density_radius=30.0))
    densities = {sequence: decode(topics.DENSITY, payload) for sequence, payload in fed.feed(17).items()}
    assert sorted(densities) == list(range(17))
    assert fed.answers == list(range(18))
    assert [densities[n].level for n in (0, 1)] == [DensityLevel.UNKNOWN] * 2
    assert densities[16].position == pytest.approx((16.0, 0.0, 0.0))
    assert densities[16].timestamp_ns == 1_600_000_000
    assert (densities[16].level, densities[16].moving_objects) == (DensityLevel.HIGH, 1)
    assert fed.service.metrics()["landmarks_moving"] == 36.0
    fed.close()
    assert not (tmp_path / "map.sqlite-wal").exists()
    assert load_view(tmp_path / "map.sqlite").sequence == 17


def test_a_repeated_frame_is_answered_and_not_put_again(tmp_path: Path) -> None:
    fed = FedMapstore(config_of(tmp_path, serve_http=False))
    first = fed.feed(9)
    again = []
    for sequence in (7, 8, 8):
        fed.send(sequence)
        while fed.loop.step(0.0):
            pass
        while (message := fed.heard.receive(0.0)) is not None:
            if message.topic is topics.DENSITY:
                again.append((message.envelope.sequence, message.payload))
    assert again == [(sequence, first[sequence]) for sequence in (7, 8, 8)]
    fed.close()
    assert len(load_view(tmp_path / "map.sqlite").frames.sequence) == 9


def test_the_gateway_answers_from_the_newest_frame_until_it_is_closed(tmp_path: Path) -> None:
    fed = FedMapstore(config_of(tmp_path))
    url = fed.service._gateway.url
    fed.feed(9)
    with urllib.request.urlopen(f"{url}/density") as answer:
        assert b'"sequence":9' in answer.read()
    fed.close()
    with pytest.raises(OSError, match="refused"):
        urllib.request.urlopen(f"{url}/density")


def test_a_port_in_use_is_one_line_and_leaves_the_map_closed(tmp_path: Path) -> None:
    first = FedMapstore(config_of(tmp_path / "a"))
    port = int(first.service._gateway.url.rsplit(":", 1)[1])
    with pytest.raises(ResourceError, match=f"port {port} on 127.0.0.1 is in use") as error:
        MapstoreService(config_of(tmp_path / "b", http_port=port))
    assert error.value.exit_code == 2
    first.close()


def test_an_address_of_another_machine_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"192\.0\.2\.1:0 cannot be listened on"):
        MapstoreService(config_of(tmp_path, http_host="192.0.2.1"))


def test_a_map_that_vanished_during_a_run_is_one_line(tmp_path: Path) -> None:
    fed = FedMapstore(config_of(tmp_path, serve_http=False))
    fed.feed(5)
    fed.close()
    (tmp_path / "map.sqlite").unlink()
    with pytest.raises(ResourceError, match="ends at frame -1, expected frame 5, which was answered"):
        FedMapstore(config_of(tmp_path, serve_http=False))


def test_session_of_the_map_is_the_runs(tmp_path: Path) -> None:
    fed = FedMapstore(config_of(tmp_path, serve_http=False))
    fed.feed(3)
    assert fed.service._live.view.session == SESSION
    fed.close()
