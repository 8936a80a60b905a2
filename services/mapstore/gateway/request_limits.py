# SPDX-License-Identifier: Apache-2.0
"""Refuses request bodies before they are read: no request of this gateway needs one."""

import asyncio
import contextlib
import json

from starlette.types import ASGIApp, Receive, Scope, Send

_DRAINED_BYTES = 16 << 20
_DRAINED_S = 2.0
"""What is read of a refused body, and thrown away: a client that sends before it listens still hears why."""


class BodyLimit:
    """ASGI middleware: 413 for a body above `max_bytes` or of unknown length."""

    def __init__(self, app: ASGIApp, max_bytes: int) -> None:
        self._app = app
        self._max_bytes = max_bytes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = dict(scope["headers"])
        length = headers.get(b"content-length", b"0").decode("latin-1")
        if b"transfer-encoding" in headers:
            await self._refuse(
                receive, send, f"request body of unknown length: expected at most {self._max_bytes} bytes"
            )
        elif int(length) > self._max_bytes:
            await self._refuse(receive, send, f"request body of {length} bytes: expected at most {self._max_bytes}")
        else:
            await self._app(scope, receive, send)

    @staticmethod
    async def _refuse(receive: Receive, send: Send, detail: str) -> None:
        body = json.dumps({"detail": detail}).encode()
        headers = [
            (b"content-type", b"application/json"),
            (b"content-length", str(len(body)).encode()),
            (b"connection", b"close"),
        ]
        await send({"type": "http.response.start", "status": 413, "headers": headers})
        await send({"type": "http.response.body", "body": body, "more_body": True})
        with contextlib.suppress(TimeoutError):  # a client that slow has been told
            await asyncio.wait_for(_drain(receive), _DRAINED_S)
        await send({"type": "http.response.body", "body": b""})


async def _drain(receive: Receive) -> None:
    drained = 0
    while drained < _DRAINED_BYTES:
        message = await receive()
        drained += len(message.get("body", b""))
        if not message.get("more_body", False):
            return
