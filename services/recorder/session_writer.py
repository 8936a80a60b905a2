# SPDX-License-Identifier: Apache-2.0
"""One MCAP file that grows by whole chunks and survives kill -9 between any two instructions."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, NoReturn

from mcap.records import Channel, ChunkIndex, Header, Message, Metadata, MetadataIndex, Schema

from services.recorder.chunk import encode_chunk, record_bytes
from services.recorder.disk_reserve import DiskReserve
from services.recorder.message_schema import descriptor_set
from services.recorder.recorded_key import topic_and_suffix
from services.recorder.summary import closing_bytes
from services.runtime.errors import InputError, ResourceError
from services.runtime.session_chunk import DamagedChunkError, read_chunk
from services.runtime.session_file import (
    CONFIG_METADATA,
    SESSION_METADATA,
    RecordedMessage,
)
from services.runtime.session_scan import MAGIC, ScannedSession, scan_session

LIBRARY = "kinemap"
REMEMBERED_CHUNKS = 64
"""how far back a restarted recorder knows what it has written: far more frames than are ever in flight"""


@dataclass(frozen=True)
class WriterOptions:
    """How a session is written."""

    zstd_level: int = 1
    """0: not compressed"""
    reserve_bytes: int = 4 << 20
    """disk space kept for the index of the file, about 300 bytes a frame"""


class SessionWriter:
    """Appends chunks to a session; opens one that was cut off where it was whole, and goes on.

    A chunk and its message indexes go to the file in one piece, and `append` returns when the operating system has
    them: they outlive this process. The index of the whole file is kept in memory and written by `finish`; a file that
    was killed before is walked (`session_scan`), not read, to get it back.

    Raises:
        InputError: the path holds another session, or something that is no session.
        ResourceError: the disk is full or fails.
    """

    def __init__(self, path: Path, session: str, config_json: str = "{}", options: WriterOptions | None = None) -> None:
        self.path = path
        self._options = options or WriterOptions()
        self._found = ScannedSession()
        self.recovered: list[tuple[str, int]] = []
        """key and sequence of the last messages that were there already, oldest first; empty for a new file"""
        self.finished = False
        self._full: ResourceError | None = None
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._reserve = DiskReserve(path, self._options.reserve_bytes)
            self._file = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        except OSError as error:
            raise ResourceError(f"{path}: cannot be written: {error.strerror}") from error
        try:
            if not self._resume(session):
                self._begin(session, config_json)
        except BaseException:
            self.close()
            raise

    @property
    def size(self) -> int:
        """Bytes that are whole on disk."""
        return self._found.whole_until

    @property
    def message_count(self) -> int:
        """Messages in the file."""
        return sum(self._found.message_counts.copy().values())

    def append(self, messages: Sequence[RecordedMessage]) -> None:
        """Write `messages` as one chunk, in this order; all of them are on disk then, or none.

        Raises:
            ResourceError: the disk is full or fails. The session was closed before: what it held stays readable.
        """
        if not messages:
            return
        if self._full is not None:
            raise self._full
        if self.finished:
            self._reopen()
        head, ids = self._describe({message.key for message in messages})
        chunk = encode_chunk(messages, ids, self._found.whole_until + len(head), self._options.zstd_level)
        try:
            self._found.whole_until += self._write(head + chunk.data)
        except OSError as error:
            self._stop(error)
        self._found.chunks.append(chunk.index_record)
        for channel_id, count in chunk.message_counts.items():
            self._found.message_counts[channel_id] = self._found.message_counts.get(channel_id, 0) + count

    def finish(self) -> None:
        """Write the index and make the file durable; again does no harm. Raises ResourceError."""
        if self.finished:
            return
        self._reserve.release()
        try:
            self._write(closing_bytes(self._found))
            os.fsync(self._file)
        except OSError as error:
            self._cut()
            raise ResourceError(f"{self.path}: its index cannot be written: {error.strerror}") from error
        self.finished = True

    def close(self) -> None:
        """Let go of the file as it is; `finish` comes first where the session is over."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1
        if self.finished:
            self._reserve.release()

    def _begin(self, session: str, config_json: str) -> None:
        data = MAGIC + record_bytes(Header(profile="", library=LIBRARY))
        for name, entries in ((SESSION_METADATA, {"session": session}), (CONFIG_METADATA, {"json": config_json})):
            metadata = record_bytes(Metadata(name=name, metadata=entries))
            self._found.metadata_indexes.append(MetadataIndex(len(data), len(metadata), name))
            self._found.metadata[name] = entries
            data += metadata
        self._found.whole_until = 0
        os.ftruncate(self._file, 0)
        try:
            self._found.whole_until = self._write(data)
        except OSError as error:
            raise ResourceError(f"{self.path}: cannot be written: {error.strerror}") from error

    def _resume(self, session: str) -> bool:
        """Go on with the file that is there; False when nothing of a session is in it."""
        with self.path.open("rb") as stream:
            if not MAGIC.startswith(stream.read(len(MAGIC))):
                raise InputError(f"{self.path}: holds something that is no recorded session; choose another folder")
            found = scan_session(stream, os.fstat(self._file).st_size)
            if found.chunks and not found.last_chunk_sealed and not _all_indexed(stream, found.chunks[-1]):
                # Killed between a chunk and its message indexes: the frame was not answered, and comes again.
                os.ftruncate(self._file, found.chunks[-1].chunk_start_offset)
                found = scan_session(stream, os.fstat(self._file).st_size)
            recorded = found.metadata.get(SESSION_METADATA, {}).get("session")
            if recorded != session and (recorded is not None or found.chunks):
                raise InputError(f"{self.path}: holds the session {recorded!r}, not {session!r}; choose another folder")
            if not found.chunks:
                return False
            self._found = found
            self.recovered = [
                name for chunk in found.chunks[-REMEMBERED_CHUNKS:] for name in self._names(stream, chunk)
            ]
        self.finished = found.finished
        if not self.finished:
            self._cut()
        return True

    def _names(self, stream: BinaryIO, chunk: ChunkIndex) -> list[tuple[str, int]]:
        try:
            records = read_chunk(stream, chunk)
        except DamagedChunkError as error:
            raise InputError(
                f"{self.path}: the chunk at byte {chunk.chunk_start_offset} is damaged ({error}); choose another folder"
            ) from error
        channels = self._found.channels
        return [(channels[entry.channel_id].topic, entry.sequence) for entry in records if isinstance(entry, Message)]

    def _describe(self, keys: set[str]) -> tuple[bytes, dict[str, int]]:
        """The schemas and channels that the file does not hold yet for `keys`, and the channel of each key."""
        head = b""
        ids = {channel.topic: channel.id for channel in self._found.channels.values()}
        schemas = {schema.name: schema.id for schema in self._found.schemas.values()}
        for key in sorted(keys - ids.keys()):
            topic, _ = topic_and_suffix(key)
            name = topic.message.DESCRIPTOR.full_name
            if name not in schemas:
                schema = Schema(len(schemas) + 1, descriptor_set(topic.message), "protobuf", name)
                head += record_bytes(schema)
                schemas[name] = schema.id
                self._found.schemas[schema.id] = schema
            channel = Channel(len(ids) + 1, key, "protobuf", {}, schemas[name])
            head += record_bytes(channel)
            ids[key] = channel.id
            self._found.channels[channel.id] = channel
        return head, ids

    def _write(self, data: bytes) -> int:
        """Write at the end of what is whole; what a failure leaves behind is cut off by the caller."""
        view, offset = memoryview(data), self._found.whole_until
        while view:
            written = os.pwrite(self._file, view, offset)
            view, offset = view[written:], offset + written
        return len(data)

    def _cut(self) -> None:
        os.ftruncate(self._file, self._found.whole_until)

    def _reopen(self) -> None:
        """Take the index off a finished file: a session that was ended goes on after all."""
        self._cut()
        self.finished = False

    def _stop(self, error: OSError) -> NoReturn:
        self._cut()
        self.finish()
        self._full = ResourceError(
            f"{self.path}: {error.strerror}; the recording ends here, whole and readable: {self.message_count} messages"
        )
        raise self._full from error


def _all_indexed(stream: BinaryIO, chunk: ChunkIndex) -> bool:
    try:
        records = read_chunk(stream, chunk)
    except DamagedChunkError:
        return False
    channels = {record.channel_id for record in records if isinstance(record, Message)}
    return channels == chunk.message_index_offsets.keys()
