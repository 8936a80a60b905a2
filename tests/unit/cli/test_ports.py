# SPDX-License-Identifier: Apache-2.0
import socket

import pytest

from services.cli.ports import any_free_port, gateway_url, is_free, require_gateway_port
from services.runtime.config import load_config
from services.runtime.errors import ResourceError


def test_a_port_in_use_is_one_line_with_exit_code_2() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert not is_free("127.0.0.1", port)
        config = load_config(None, {"mapstore": {"http_port": port}})
        with pytest.raises(ResourceError, match=f"HTTP gateway: port {port} on 127.0.0.1 is in use") as raised:
            require_gateway_port(config)
        assert raised.value.exit_code == 2
        require_gateway_port(load_config(None, {"mapstore": {"http_port": port, "serve_http": False}}))
    assert is_free("127.0.0.1", port)


def test_a_free_port_is_free_and_an_address_of_others_is_not() -> None:
    assert is_free("127.0.0.1", any_free_port())
    assert not is_free("192.0.2.1", 8000)


def test_where_the_gateway_answers() -> None:
    assert gateway_url(load_config(None, {"mapstore": {"http_port": 8123}})) == "http://127.0.0.1:8123"
    assert "serve_http is false" in gateway_url(load_config(None, {"mapstore": {"serve_http": False}}))
