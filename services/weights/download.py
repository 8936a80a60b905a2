# SPDX-License-Identifier: Apache-2.0
"""Fetches one file, going on where it was cut off. Proxies are those of http_proxy and https_proxy."""

import http.client
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit
from urllib.request import Request, build_opener

from services.runtime.errors import InputError, ResourceError
from services.weights.checksum import require_sha256_prefix

_TIMEOUT_S = 30
_CHUNK = 1 << 16
_PARTIAL_CONTENT = 206
_RANGE_NOT_SATISFIABLE = 416

Progress = Callable[[int, int | None], None]
"""Bytes so far, and in all where the server says it."""


def download(url: str, target: Path, sha256_prefix: str, progress: Progress | None = None) -> str:
    """Fetch `url` to `target` and return its SHA-256; until it is whole it lies beside it as `.part`.

    Raises:
        ResourceError: the server cannot be reached, the transfer was cut off, or there is no room.
        InputError: the server has no such file, or what came has another checksum (it is then removed).
    """
    part = target.with_name(f"{target.name}.part")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        _fetch(url, part, progress or (lambda done, total: None))
    except HTTPError as error:
        raise InputError(f"{url}: the server answers {error.code} {error.reason}, expected the file") from error
    except (URLError, TimeoutError, ConnectionError, http.client.HTTPException) as error:
        reason = getattr(error, "reason", None) or error
        raise ResourceError(
            f"{urlsplit(url).hostname} cannot be reached ({reason}): get {url} elsewhere and "
            "`kinemap weights import FILE`, or set https_proxy"
        ) from error
    except OSError as error:
        raise ResourceError(f"{part}: cannot be written ({error.strerror})") from error
    try:
        digest = require_sha256_prefix(part, sha256_prefix)
    except InputError:
        part.unlink(missing_ok=True)
        raise
    part.replace(target)
    return digest


def _fetch(url: str, part: Path, progress: Progress) -> None:
    done = part.stat().st_size if part.is_file() else 0
    request = Request(url, headers={"Range": f"bytes={done}-"} if done else {})
    try:
        response = build_opener().open(request, timeout=_TIMEOUT_S)
    except HTTPError as error:
        if done and error.code == _RANGE_NOT_SATISFIABLE:  # all of it is here already
            return
        raise
    with response:
        _receive(response, url, part, done if response.status == _PARTIAL_CONTENT else 0, progress)


def _receive(response: Any, url: str, part: Path, done: int, progress: Progress) -> None:
    length = response.headers.get("Content-Length")
    total = done + int(length) if length is not None else None
    if total is not None and shutil.disk_usage(part.parent).free < total - done:
        raise ResourceError(f"{part.parent}: no room for {(total - done) / 1e6:.0f} MB")
    with part.open("r+b" if done else "wb") as file:
        file.seek(done)
        while chunk := response.read(_CHUNK):
            file.write(chunk)
            done += len(chunk)
            progress(done, total)
    if total is not None and done < total:
        raise ResourceError(f"{url}: cut off after {done} of {total} bytes, the same command goes on from there")
