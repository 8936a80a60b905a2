# SPDX-License-Identifier: Apache-2.0
"""Whether a port of this machine is to be had."""

import socket

from services.runtime.config import Config
from services.runtime.errors import ResourceError


def is_free(host: str, port: int) -> bool:
    """Whether a server could listen there now."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        # As servers do: a port whose last connection is only winding down counts as free.
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError:
            return False
    return True


def require_free(host: str, port: int, what: str) -> None:
    """Raise ResourceError in one line where `what` cannot listen on the port."""
    if not is_free(host, port):
        raise ResourceError(
            f"{what}: port {port} on {host} is in use, expected a free one; choose another or stop its user"
        )


def require_gateway_port(config: Config) -> None:
    """Raise ResourceError where the HTTP gateway could not listen."""
    if config.mapstore.serve_http and config.mapstore.http_port:
        require_free(config.mapstore.http_host, config.mapstore.http_port, "HTTP gateway")


def gateway_url(config: Config) -> str:
    """Where the HTTP gateway answers, for people."""
    if not config.mapstore.serve_http:
        return "no HTTP gateway (mapstore.serve_http is false)"
    return f"http://{config.mapstore.http_host}:{config.mapstore.http_port}"


def any_free_port(host: str = "127.0.0.1") -> int:
    """A port that is free at this moment."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.bind((host, 0))
        return int(probe.getsockname()[1])
