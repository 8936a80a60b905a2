# SPDX-License-Identifier: Apache-2.0
"""The durable map: every frame is one transaction, so that a kill leaves a whole frame or none of it."""

import contextlib
import sqlite3
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from schemas.records import Density, MapUpdate, TrackedFrame
from services.mapstore import dense_table, map_file, map_rows
from services.mapstore.map_state import MapState
from services.mapstore.map_view import NOT_YET
from services.runtime.errors import InputError, KinemapError, ResourceError

Result = TypeVar("Result")


class MapStore:
    """Writes frames to a map.sqlite and knows the last one that is in it. For one thread."""

    def __init__(self, path: Path, session: str) -> None:
        """Opens the map of `session`, or makes one.

        Raises InputError when it holds another session's, and what map_file raises.
        """
        self.path = path
        self._session = session
        self._connection = map_file.open_to_write(path)
        row = self._guarded(lambda: self._connection.execute("SELECT session, sequence FROM progress").fetchone())
        self.last_sequence: int = NOT_YET if row is None else row[1]
        if row is not None and row[0] != session:
            self._connection.close()
            raise InputError(f"{path}: holds the map of session '{row[0]}', expected '{session}' or a new file")

    def load(self) -> MapState:
        """The map that is in the file."""
        state = self._guarded(lambda: read_map(self._connection))
        state.session = self._session
        return state

    def put(self, sequence: int, frame: TrackedFrame, update: MapUpdate, density: Density) -> None:
        """One frame, all of it or nothing.

        Raises InputError when the frame is in the map already, ResourceError when the disk is full; the frames before
        stay readable then.
        """
        if sequence <= self.last_sequence:
            raise InputError(f"{self.path}: frame {sequence}, expected one after {self.last_sequence}")
        self._guarded(lambda: self._put_frame(sequence, frame, update, density))
        self.last_sequence = sequence

    def put_last_update(self, sequence: int, update: MapUpdate) -> None:
        """What changed after the last frame, the input having ended under `sequence`. Raises ResourceError as `put`."""
        self._guarded(lambda: self._put_last_update(sequence, update))
        self.last_sequence = max(self.last_sequence, sequence)

    def density_of(self, sequence: int) -> Density | None:
        """What was answered for a frame, None where there is no such frame."""
        query = "SELECT timestamp_ns, densities.* FROM densities JOIN frames USING (sequence) WHERE sequence = ?"
        row = self._guarded(lambda: self._connection.execute(query, (sequence,)).fetchone())
        return None if row is None else map_rows.density_of(row[0], row[1:])

    def checkpoint(self) -> None:
        """Moves the write-ahead log into the file and syncs it, so that map.sqlite alone is the whole map."""
        self._guarded(lambda: self._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone())

    def close(self) -> None:
        """Leaves one file as the last `put` left it, unless somebody reads it now: then the log stays beside it."""
        with contextlib.suppress(sqlite3.Error):
            self._connection.execute("PRAGMA busy_timeout = 0")
            self._connection.execute("PRAGMA journal_mode = DELETE")
        self._connection.close()

    def _put_frame(self, sequence: int, frame: TrackedFrame, update: MapUpdate, density: Density) -> None:
        run = self._connection.execute
        run("BEGIN IMMEDIATE")
        run(map_rows.INSERT_FRAME, map_rows.frame_row(sequence, frame))
        self._put_update(sequence, update)
        run(map_rows.INSERT_DENSITY, map_rows.density_row(sequence, density))
        progress = (self._session, sequence, frame.timestamp_ns, frame.map_id, int(frame.metric_scale))
        run(map_rows.REPLACE_PROGRESS, progress)
        run("COMMIT")

    def _put_last_update(self, sequence: int, update: MapUpdate) -> None:
        run = self._connection.execute
        run("BEGIN IMMEDIATE")
        self._put_update(sequence, update)
        run("UPDATE progress SET sequence = ?", (sequence,))
        run("COMMIT")

    def _put_update(self, sequence: int, update: MapUpdate) -> None:
        many = self._connection.executemany
        many(map_rows.UPSERT_KEYFRAME, map_rows.keyframe_rows(update))
        many(map_rows.UPSERT_LANDMARK, map_rows.landmark_rows(update))
        removed = update.removed_landmark_id.tolist()
        many(map_rows.DELETE_LANDMARK, ((number,) for number in removed))
        many(map_rows.BURY_LANDMARK, ((number, sequence) for number in removed))
        many(dense_table.REPLACE_CLOUD, dense_table.cloud_rows(update))
        many(map_rows.CORRECT_FRAME, map_rows.correction_rows(update))

    def _guarded(self, work: Callable[[], Result]) -> Result:
        try:
            return work()
        except sqlite3.Error as error:
            if self._connection.in_transaction:
                self._connection.execute("ROLLBACK")
            raise self._named(error) from error

    def _named(self, error: sqlite3.Error) -> KinemapError:
        name = getattr(error, "sqlite_errorname", "")
        if name == "SQLITE_FULL" or name.startswith("SQLITE_IOERR"):
            return ResourceError(
                f"{self.path}: the disk is full or failing ({error}); frames up to {self.last_sequence} stay readable"
            )
        if isinstance(error, sqlite3.OperationalError):
            return ResourceError(f"{self.path}: cannot be used ({error}); frames up to {self.last_sequence} are in it")
        return InputError(f"{self.path}: damaged ({error})")


def read_map(connection: sqlite3.Connection) -> MapState:
    """The map in a file opened by map_file. Frames come first, so that what refers to them finds them."""
    state = MapState()
    run = connection.execute
    run("BEGIN")
    progress = run("SELECT * FROM progress").fetchone()
    frames = run("SELECT * FROM frames ORDER BY sequence").fetchall()
    update = map_rows.update_of(connection)
    dense_points = dense_table.point_counts(connection)
    run("COMMIT")
    if progress is None:
        return state
    _, state.session, sequence, _, _, metric_scale = progress
    state.apply(update)
    state.count_dense_points(dense_points)
    for row in frames:
        state.add_frame(row[0], map_rows.frame_of(row, bool(metric_scale)))
    state.finish(sequence)
    return state
