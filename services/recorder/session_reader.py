# SPDX-License-Identifier: Apache-2.0
"""A recorded session as records: what went over the bus, decoded."""

from collections.abc import Collection, Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Self

from schemas.codec import decode
from schemas.topics import Topic
from services.recorder.recorded_key import topic_and_suffix
from services.runtime.envelope import Envelope
from services.runtime.session_file import SessionFile


class SessionRecord(NamedTuple):
    """One message of a session, decoded. `suffix` is its sender, where every service sends its own."""

    topic: Topic
    suffix: str
    envelope: Envelope
    record: Any


class SessionReader:
    """Iterates over a session's records, and seeks in it by time and topic.

    Raises:
        InputError: no such file, not MCAP, or cut off (without `recover`).
        ProtocolError: from `records`, a message of another version.
    """

    def __init__(self, path: Path, recover: bool = False) -> None:
        self.file = SessionFile(path, recover)

    def records(
        self, topics: Collection[Topic] | None = None, start_ns: int | None = None, end_ns: int | None = None
    ) -> Iterator[SessionRecord]:
        """Records in the order they were written, of these `topics` and capture times (both ends included) only."""
        keys = None
        if topics is not None:
            keys = {key for key in self.file.keys if topic_and_suffix(key)[0] in topics}
        for message in self.file.messages(keys, start_ns, end_ns):
            topic, suffix = topic_and_suffix(message.key)
            envelope = Envelope(self.file.session, message.sequence, message.timestamp_ns)
            yield SessionRecord(topic, suffix, envelope, decode(topic, message.payload))

    def close(self) -> None:
        """Close the file."""
        self.file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
