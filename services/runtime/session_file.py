# SPDX-License-Identifier: Apache-2.0
"""A recorded session (MCAP), read: by topic, by time, by sequence; whole, or cut off and recovered."""

import json
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Self

from mcap.exceptions import McapError
from mcap.reader import SeekingReader
from mcap.records import Channel, ChunkIndex, Footer, McapRecord, Message

from services.runtime.errors import InputError
from services.runtime.session_chunk import DAMAGE, DamagedChunkError, indexed_times, read_chunk
from services.runtime.session_scan import MAGIC, read_footer, scan_session, summary_is_whole

SESSION_METADATA = "kinemap.session"
CONFIG_METADATA = "kinemap.config"
_HOW_TO_RECOVER = "`python -m services.recorder.recovery FILE OUT` makes a whole session of what is there"


class RecordedMessage(NamedTuple):
    """One message as it was on the bus. `key` is its topic's, with `/<service>` behind it where there is one."""

    key: str
    sequence: int
    timestamp_ns: int
    payload: bytes


@dataclass(frozen=True)
class IndexedMessage:
    """Where one message lies, known without reading it."""

    key: str
    chunk: ChunkIndex
    timestamp_ns: int
    number: int
    """among the messages of its key in its chunk"""


class SessionFile:
    """A session on disk. Not for several threads at once.

    With `recover`, a file that was cut off or damaged gives every whole message; without, it is refused, so that
    nobody takes half a session for a whole one.

    Raises:
        InputError: no such file, not MCAP, or (without `recover`) cut off: the line says at which byte and what to do.
    """

    def __init__(self, path: Path, recover: bool = False) -> None:
        if not path.is_file():
            raise InputError(f"{path}: no such file; expected a recorded session (.mcap)")
        self.path = path
        self.recovered = ""
        """why the file had to be recovered; empty for a whole file"""
        self.damaged_chunks = 0
        """chunks that were skipped so far because their bytes are not those that were written (only with `recover`)"""
        self._recover = recover
        self._stream = path.open("rb")
        try:
            self._open(path.stat().st_size)
        except BaseException:
            self._stream.close()
            raise
        self._read: tuple[int, list[McapRecord]] = (-1, [])

    def _open(self, size: int) -> None:
        if self._stream.read(len(MAGIC)) != MAGIC:
            raise InputError(f"{self.path}: not an MCAP file; expected a recorded session (.mcap)")
        footer = read_footer(self._stream, size)
        if footer is not None:
            try:
                self._open_by_index(footer, size)
                return
            except DAMAGE as error:
                if not self._recover:
                    why = str(error) or type(error).__name__
                    raise InputError(f"{self.path}: its index is damaged ({why}); {_HOW_TO_RECOVER}") from error
        self._open_by_walk(size)

    def _open_by_index(self, footer: Footer, size: int) -> None:
        if not summary_is_whole(self._stream, footer, size):
            raise McapError("its checksum is another")
        self._stream.seek(0)
        reader = SeekingReader(self._stream)
        summary = reader.get_summary()
        if summary is None or (not summary.chunk_indexes and summary.statistics and summary.statistics.message_count):
            raise McapError("no chunk index")
        self._channels: dict[int, Channel] = dict(summary.channels)
        self._chunks = sorted(summary.chunk_indexes, key=lambda chunk: chunk.chunk_start_offset)
        self._counts = dict(summary.statistics.channel_message_counts) if summary.statistics else {}
        self.metadata: dict[str, dict[str, str]] = {entry.name: entry.metadata for entry in reader.iter_metadata()}

    def _open_by_walk(self, size: int) -> None:
        found = scan_session(self._stream, size)
        if not self._recover:
            raise InputError(
                f"{self.path}: {found.problem}; {len(found.chunks)} whole chunks up to byte {found.whole_until} "
                f"({sum(found.message_counts.values())} messages) are there; {_HOW_TO_RECOVER}"
            )
        self.recovered = found.problem or "its index is damaged"
        self._channels, self._chunks = found.channels, found.chunks
        self._counts, self.metadata = found.message_counts, found.metadata

    @property
    def session(self) -> str:
        """The id of the session, empty when the file does not say."""
        return self.metadata.get(SESSION_METADATA, {}).get("session", "")

    @property
    def config(self) -> dict[str, Any]:
        """The resolved configuration that the session ran with, section by section; empty when the file does not say.

        Raises:
            InputError: the file says something that is no configuration.
        """
        text = self.metadata.get(CONFIG_METADATA, {}).get("json", "{}")
        try:
            values = json.loads(text)
        except ValueError as error:
            raise InputError(f"{self.path}: its configuration is no JSON: {error}") from error
        return values if isinstance(values, dict) else {}

    @property
    def keys(self) -> set[str]:
        """The topics that the file describes."""
        return {channel.topic for channel in self._channels.values()}

    def message_counts(self) -> dict[str, int]:
        """Messages by key, sorted by key; of a recovered file, as far as its message indexes are whole."""
        counts = {channel.topic: self._counts.get(channel.id, 0) for channel in self._channels.values()}
        return {key: counts[key] for key in sorted(counts) if counts[key]}

    def messages(
        self,
        keys: Collection[str] | None = None,
        start_ns: int | None = None,
        end_ns: int | None = None,
    ) -> Iterator[RecordedMessage]:
        """The messages in the order they were written, which is that of their frames.

        Args:
            keys: only these topics' (a chunk without any of them is not read).
            start_ns: only those with this capture time or a later one.
            end_ns: only those with this capture time or an earlier one.

        Raises:
            InputError: a chunk is damaged (not with `recover`: then it is skipped and counted).
        """
        for chunk in self._chunks:
            if (end_ns is not None and chunk.message_start_time > end_ns) or (
                start_ns is not None and chunk.message_end_time < start_ns
            ):
                continue
            if keys is None or self._may_hold(chunk, keys):
                for message in self._messages_of(chunk):
                    inside = (start_ns is None or message.timestamp_ns >= start_ns) and (
                        end_ns is None or message.timestamp_ns <= end_ns
                    )
                    if inside and (keys is None or message.key in keys):
                        yield message

    def index_of(self, key: str) -> list[IndexedMessage]:
        """Where the messages of one topic lie, in file order, without reading a chunk whose index is whole."""
        wanted = {channel.id for channel in self._channels.values() if channel.topic == key}
        places: list[IndexedMessage] = []
        for chunk in self._chunks:
            indexed = [
                indexed_times(self._stream, chunk, number) for number in wanted & chunk.message_index_offsets.keys()
            ]
            if None in indexed or (self.recovered and chunk is self._chunks[-1]):
                indexed = [[message.timestamp_ns for message in self._messages_of(chunk) if message.key == key]]
            times = [time_ns for channel_times in indexed for time_ns in channel_times or ()]
            places += [IndexedMessage(key, chunk, time_ns, number) for number, time_ns in enumerate(times)]
        return places

    def at(self, place: IndexedMessage) -> RecordedMessage:
        """The message that lies there. Raises InputError when its chunk is damaged."""
        of_key = [message for message in self._messages_of(place.chunk) if message.key == place.key]
        if place.number >= len(of_key):
            raise self._damaged(place.chunk, f"{len(of_key)} messages of {place.key}, its index names more")
        return of_key[place.number]

    def beside(self, place: IndexedMessage) -> list[RecordedMessage]:
        """All messages of the chunk in which that message lies: in kinemap's own recordings those of its frame."""
        return list(self._messages_of(place.chunk))

    def close(self) -> None:
        """Close the file."""
        self._stream.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _may_hold(self, chunk: ChunkIndex, keys: Collection[str]) -> bool:
        if not chunk.message_index_offsets or self.recovered:
            return True
        channels = (self._channels.get(number) for number in chunk.message_index_offsets)
        return any(channel is None or channel.topic in keys for channel in channels)

    def _messages_of(self, chunk: ChunkIndex) -> Iterator[RecordedMessage]:
        try:
            records = self._records_of(chunk)
        except InputError:
            if not self._recover:
                raise
            self.damaged_chunks += 1
            return
        for record in records:
            if isinstance(record, Channel):
                self._channels.setdefault(record.id, record)
            elif isinstance(record, Message) and (channel := self._channels.get(record.channel_id)) is not None:
                yield RecordedMessage(channel.topic, record.sequence, record.log_time, record.data)
            elif isinstance(record, Message) and not self._recover:
                raise self._damaged(chunk, f"it holds channel {record.channel_id}, which the file does not describe")

    def _records_of(self, chunk: ChunkIndex) -> list[McapRecord]:
        if self._read[0] != chunk.chunk_start_offset:
            try:
                self._read = (chunk.chunk_start_offset, read_chunk(self._stream, chunk))
            except DamagedChunkError as error:
                raise self._damaged(chunk, str(error)) from error
        return self._read[1]

    def _damaged(self, chunk: ChunkIndex, why: str) -> InputError:
        return InputError(f"{self.path}: the chunk at byte {chunk.chunk_start_offset} is damaged: {why}")
