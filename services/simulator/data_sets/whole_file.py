# SPDX-License-Identifier: Apache-2.0
"""Files that are there whole or not at all, and how one knows them again."""

from __future__ import annotations

import errno
import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from services.runtime.errors import ResourceError

PART_SUFFIX = ".part"


@dataclass(frozen=True, slots=True)
class WrittenFile:
    """A file of a data set: `name` relative to its folder with forward slashes, and what is in it."""

    name: str
    size_bytes: int
    sha256: str


def write_whole(root: Path, name: str, write: Callable[[Path], object]) -> WrittenFile:
    """Let `write` fill a temporary file, then give it its name below `root`; folders are made.

    A kill leaves the file as it was before, and a `.part` beside it.

    Raises:
        ResourceError: the disk is full or does not take it; names the file.
    """
    path = root / name
    # Two processes may write the same frame for a moment: one whose parent was killed, and its successor.
    part = path.with_name(f".{path.name}.{os.getpid()}{PART_SUFFIX}")
    with disk_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            write(part)
            data = part.read_bytes()
            part.replace(path)
        except BaseException:
            part.unlink(missing_ok=True)
            raise
    return WrittenFile(name, len(data), hashlib.sha256(data).hexdigest())


@contextmanager
def disk_errors(path: Path) -> Iterator[None]:
    """What the disk refuses becomes a ResourceError that names `path`."""
    try:
        yield
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise ResourceError(f"{path}: the disk is full; free some space and give the same command again") from error
        raise ResourceError(f"{path}: cannot be written ({error.strerror}), expected a folder to write to") from error


def remove_parts(root: Path) -> None:
    """Remove what a killed process left half written."""
    for part in root.rglob(f".*{PART_SUFFIX}"):
        part.unlink(missing_ok=True)
