# SPDX-License-Identifier: Apache-2.0
"""Whether a file is the one that was published."""

import hashlib
from pathlib import Path

from services.runtime.errors import InputError

_CHUNK = 1 << 20


def sha256_of(path: Path) -> str:
    """64 hex digits. Raises InputError when the file cannot be read."""
    digest = hashlib.sha256()
    try:
        with path.open("rb") as file:
            while chunk := file.read(_CHUNK):
                digest.update(chunk)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    return digest.hexdigest()


def require_sha256_prefix(path: Path, prefix: str) -> str:
    """The file's SHA-256. Raises InputError when it does not begin with `prefix`."""
    found = sha256_of(path)
    if not found.startswith(prefix):
        raise InputError(
            f"{path}: its SHA-256 begins with {found[: len(prefix)]}, expected {prefix}: the file is damaged, cut off "
            "or another one"
        )
    return found
