# SPDX-License-Identifier: Apache-2.0
"""The inputs of every frame since the last checkpoint, on disk: the engine is deterministic, so they are its state."""

import struct
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

from schemas.codec import decode, encode
from schemas.topics import BY_KEY, Topic
from services.runtime.envelope import Envelope
from services.runtime.errors import ResourceError
from services.runtime.service import Bundle

_FRAME = struct.Struct("<qqI")
_RECORD = struct.Struct("<IQ")


class FrameJournal:
    """A file that grows frame by frame. A kill may cut its last frame off, which is then as if never written."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: BinaryIO | None = None

    def append(self, bundle: Bundle, inputs: Iterable[Topic]) -> None:
        """Write what a frame was made of. Raises ResourceError when the disk does not take it."""
        records = [(topic, bundle.get(topic)) for topic in inputs]
        present = [(topic.key.encode(), encode(topic, record)) for topic, record in records if record is not None]
        parts = [_FRAME.pack(bundle.envelope.sequence, bundle.timestamp_ns, len(present))]
        for key, payload in present:
            parts += [_RECORD.pack(len(key), len(payload)), key, payload]
        try:
            if self._file is None:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self._file = self.path.open("ab")
            self._file.write(b"".join(parts))
            self._file.flush()
        except OSError as error:
            raise ResourceError(f"{self.path}: cannot be written: {error.strerror}") from error

    def read(self, session: str, last_sequence: int) -> Iterator[Bundle]:
        """The frames up to `last_sequence`, in order; what lies behind them is forgotten."""
        if not self.path.exists():
            return
        with self.path.open("r+b") as file:
            while True:
                begin = file.tell()
                bundle = _read_frame(file, session)
                if bundle is None or bundle.envelope.sequence > last_sequence:
                    file.truncate(begin)
                    return
                yield bundle

    def close(self) -> None:
        """Let go of the file, which stays."""
        if self._file is not None:
            self._file.close()
            self._file = None


def _read_frame(file: BinaryIO, session: str) -> Bundle | None:
    """The next frame, None where the file ends or was cut off."""
    head = file.read(_FRAME.size)
    if len(head) < _FRAME.size:
        return None
    sequence, timestamp_ns, count = _FRAME.unpack(head)
    records: dict[Topic, Any] = {}
    for _ in range(count):
        sizes = file.read(_RECORD.size)
        if len(sizes) < _RECORD.size:
            return None
        key_size, payload_size = _RECORD.unpack(sizes)
        key, payload = file.read(key_size), file.read(payload_size)
        if len(payload) < payload_size:
            return None
        topic = BY_KEY[key.decode()]
        records[topic] = decode(topic, payload)
    return Bundle(Envelope(session, sequence, timestamp_ns), records)
