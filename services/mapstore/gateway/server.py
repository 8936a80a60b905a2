# SPDX-License-Identifier: Apache-2.0
"""The gateway's web server, in a thread of the service's process."""

import errno
import socket
import threading

import uvicorn

from services.mapstore.gateway.app import create_app
from services.mapstore.gateway.live_map import LiveMap
from services.runtime.config.mapstore import MapstoreConfig
from services.runtime.errors import InputError, ResourceError
from services.runtime.log import get_logger

_BACKLOG = 256
_DRAIN_S = 2


class Gateway:
    """Listens from its construction until `close`."""

    def __init__(self, options: MapstoreConfig, live: LiveMap) -> None:
        """Raises ResourceError when the port is in use, InputError when the address is none of this machine."""
        self._socket = _listen(options.http_host, options.http_port)
        host, port = self._socket.getsockname()[:2]
        self.url = f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"
        config = uvicorn.Config(
            create_app(live, options),
            log_config=None,
            log_level="warning",
            access_log=False,
            lifespan="off",
            ws="none",
            loop="asyncio",
            server_header=False,
            timeout_graceful_shutdown=_DRAIN_S,
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._serve, name="gateway", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends running answers, then stops listening."""
        self._server.should_exit = True
        self._thread.join(2 * _DRAIN_S)
        self._socket.close()

    def _serve(self) -> None:
        try:
            self._server.run(sockets=[self._socket])
        except Exception:
            get_logger("gateway").exception("gateway_failed")


def _listen(host: str, port: int) -> socket.socket:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        listening = socket.create_server((host, port), family=family, backlog=_BACKLOG)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise ResourceError(
                f"port {port} on {host} is in use; expected a free one (mapstore.http_port, 0: any)"
            ) from error
        reason = error.strerror or str(error)
        raise InputError(
            f"{host}:{port} cannot be listened on ({reason}); expected an address of this machine"
        ) from error
    # Accepted connections inherit it; without, an answer on a kept connection waits 40 ms for a delayed ACK.
    listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return listening
