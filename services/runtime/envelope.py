# SPDX-License-Identifier: Apache-2.0
"""What travels beside every message: whose it is, which frame, and when that was captured."""

import struct
from typing import NamedTuple

from services.runtime.errors import ProtocolError

_HEAD = struct.Struct("<qq")


class Envelope(NamedTuple):
    """A message's session, its frame's sequence number without gaps, and the frame's capture time."""

    session: str
    sequence: int
    timestamp_ns: int

    def to_bytes(self) -> bytes:
        """The attachment of a zenoh message."""
        return _HEAD.pack(self.sequence, self.timestamp_ns) + self.session.encode()

    @classmethod
    def from_bytes(cls, data: bytes) -> "Envelope":
        """The other way round. Raises ProtocolError when `data` is no envelope."""
        try:
            sequence, timestamp_ns = _HEAD.unpack_from(data)
            return cls(data[_HEAD.size :].decode(), sequence, timestamp_ns)
        except (struct.error, UnicodeDecodeError) as error:
            raise ProtocolError(f"attachment of {len(data)} bytes is no envelope: {error}") from error
