# SPDX-License-Identifier: Apache-2.0
"""A map.sqlite: made, opened, and refused when it is something else."""

import os
import sqlite3
from pathlib import Path

from services.runtime.errors import InputError, ResourceError

APPLICATION_ID = 0x4B4D4150
"""'KMAP', SQLite's `PRAGMA application_id` of every kinemap map."""
SCHEMA_VERSION = 2
"""`PRAGMA user_version`: what this kinemap writes, and the newest it reads."""

_ADDED_BY_VERSION = tuple(Path(__file__).with_name(name) for name in ("schema.sql", "schema_2.sql"))
_BUSY_TIMEOUT_S = 10.0


def open_to_write(path: Path) -> sqlite3.Connection:
    """The map at `path`, made when there is none; in WAL mode, so that readers never wait for the writer.

    Commits survive a killed process; a power cut may cost the last frames, whole ones. Raises InputError when the file
    is no kinemap map or of a newer version, ResourceError when it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        connection = sqlite3.connect(path, isolation_level=None, timeout=_BUSY_TIMEOUT_S, check_same_thread=False)
    except (OSError, sqlite3.Error) as error:
        raise ResourceError(f"{path}: cannot be opened to write ({_reason(error)})") from error
    try:
        if _tables(connection) == 0 and _pragma(connection, "application_id") == 0:
            _upgrade(connection, 0)
        _check(path, connection)
        _upgrade(connection, _pragma(connection, "user_version"))
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute("PRAGMA synchronous = NORMAL")
    except BaseException as error:
        connection.close()
        raise _named(path, error) from error
    return connection


def open_to_read(path: Path) -> sqlite3.Connection:
    """The map at `path`, read-only, also while a service writes it. Raises InputError when it is no such map."""
    if not path.is_file():
        raise InputError(f"{path}: no such file; expected a kinemap map (map.sqlite)")
    options = "mode=ro"
    if not os.access(path.parent, os.W_OK) and not path.with_name(f"{path.name}-wal").exists():
        options = "immutable=1"  # SQLite cannot make the files beside it that it reads a WAL database by
    try:
        connection = sqlite3.connect(f"{path.resolve().as_uri()}?{options}", uri=True, isolation_level=None)
    except sqlite3.Error as error:
        raise InputError(f"{path}: cannot be read ({error})") from error
    try:
        _check(path, connection)
    except BaseException as error:
        connection.close()
        raise _named(path, error) from error
    return connection


def _upgrade(connection: sqlite3.Connection, version: int) -> None:
    """One transaction, so that two starts at once, or a kill, leave a whole schema or the one before."""
    if version == SCHEMA_VERSION:
        return
    header = f"PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {SCHEMA_VERSION};"
    added = "\n".join(path.read_text(encoding="utf-8") for path in _ADDED_BY_VERSION[version:])
    connection.executescript(f"BEGIN IMMEDIATE; {header} {added} COMMIT;")


def _check(path: Path, connection: sqlite3.Connection) -> None:
    if _pragma(connection, "application_id") != APPLICATION_ID:
        raise InputError(f"{path}: an SQLite file, but no kinemap map")
    version = _pragma(connection, "user_version")
    if not 1 <= version <= SCHEMA_VERSION:
        raise InputError(f"{path}: map version {version}, expected at most {SCHEMA_VERSION}; a newer kinemap wrote it")


def _named(path: Path, error: BaseException) -> BaseException:
    """The error as one line about this file."""
    if isinstance(error, sqlite3.OperationalError):
        return ResourceError(f"{path}: cannot be opened ({error})")
    if isinstance(error, sqlite3.DatabaseError):
        return InputError(f"{path}: no kinemap map, or a damaged one ({error})")
    return error


def _pragma(connection: sqlite3.Connection, name: str) -> int:
    return int(connection.execute(f"PRAGMA {name}").fetchone()[0])


def _tables(connection: sqlite3.Connection) -> int:
    return int(connection.execute("SELECT count(*) FROM sqlite_schema").fetchone()[0])


def _reason(error: Exception) -> str:
    return error.strerror or str(error) if isinstance(error, OSError) else str(error)
