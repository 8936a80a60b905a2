# SPDX-License-Identifier: Apache-2.0
"""Exported networks beside the weights in the user's cache."""

import hashlib
import tempfile
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final

from services.weights.cache_folder import cache_folder

_MEMBER: Final = "network.onnx"
_SUFFIX: Final = ".zip"
_KEPT: Final = 8
"""files at most; the oldest go first"""


def exports_folder() -> Path:
    """Where they lie; the folder need not be there yet."""
    return cache_folder() / "exported"


def cached_bytes(key: str, write: Callable[[Path], None]) -> bytes:
    """What was kept under this key, else what `write` puts into the file that it is given, kept from then on.

    A file that is damaged (its sum of check is wrong, it is cut off) is made anew; where nothing can be kept, the
    network is exported at every start.
    """
    path = exports_folder() / f"{hashlib.sha256(key.encode()).hexdigest()[:32]}{_SUFFIX}"
    found = _read(path)
    if found is not None:
        return found
    with tempfile.TemporaryDirectory(prefix="kinemap-export-") as folder:
        made = Path(folder) / _MEMBER
        write(made)
        content = made.read_bytes()
    with suppress(OSError):
        _keep(path, content)
    return content


def _read(path: Path) -> bytes | None:
    try:
        with zipfile.ZipFile(path) as archive:
            return archive.read(_MEMBER)
    except (OSError, zipfile.BadZipFile, KeyError, EOFError, NotImplementedError, RuntimeError):
        return None


def _keep(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix="part-", delete=False) as part:
        try:
            with zipfile.ZipFile(part, "w", zipfile.ZIP_STORED) as archive:
                archive.writestr(_MEMBER, content)
            Path(part.name).replace(path)
        except BaseException:
            Path(part.name).unlink(missing_ok=True)
            raise
    oldest_first = sorted(path.parent.glob(f"*{_SUFFIX}"), key=lambda file: file.stat().st_mtime_ns)
    for file in oldest_first[:-_KEPT]:
        file.unlink(missing_ok=True)
