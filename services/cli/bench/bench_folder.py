# SPDX-License-Identifier: Apache-2.0
"""The folder of a benchmark: told from others by its bench.json, and written by one benchmark at a time."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

from services.cli.run_folder import RUNS
from services.evaluation.bench.file import BENCH_NAME
from services.runtime.errors import InputError, ResourceError


def bench_folder(out: Path | None, now: datetime | None = None) -> Path:
    """Where a benchmark writes: `out`, else runs/bench-<YYYYmmdd-HHMMSS>. Nothing is made yet.

    Raises InputError for a folder that holds anything but a benchmark.
    """
    folder = out or RUNS / (now or datetime.now()).strftime("bench-%Y%m%d-%H%M%S")
    try:
        if folder.exists() and not folder.is_dir():
            raise InputError(f"--out {folder}: is a file, expected a folder")
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be a folder ({error.strerror}), expected another name") from error
    if folder.is_dir() and any(folder.iterdir()) and not (folder / BENCH_NAME).is_file():
        raise InputError(f"--out {folder}: no benchmark's folder, expected one, or one that is empty or does not exist")
    return folder.resolve()


@contextmanager
def reserved(folder: Path) -> Iterator[None]:
    """Make the folder, and keep other benchmarks out of it while entered.

    Raises InputError where another one is at work in it, ResourceError where it cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise ResourceError(f"--out {folder} cannot be written: {error.strerror}") from error
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(f"--out {folder}: another benchmark is at work in it, expected it to have ended") from None
        yield
    finally:
        os.close(descriptor)
