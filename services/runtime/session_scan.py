# SPDX-License-Identifier: Apache-2.0
"""Walk over an MCAP file's records by their headers: what is whole in it, also when its end or index is missing.

Chunks are stepped over, not read, so that a file of many gigabytes is walked in about a second. Format:
https://mcap.dev/spec (records are opcode u8, length u64, content; everything little-endian).
"""

import struct
import zlib
from dataclasses import dataclass, field
from io import BytesIO
from typing import BinaryIO

from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.records import Channel, ChunkIndex, Footer, Metadata, MetadataIndex, Schema

MAGIC = b"\x89MCAP0\r\n"
_HEAD = struct.Struct("<BQ")
RECORD_HEAD_BYTES = _HEAD.size
_CHUNK_HEAD = struct.Struct("<QQQII")
"""start time, end time, uncompressed size, uncompressed crc, length of the compression's name"""
_MESSAGE_INDEX_HEAD = struct.Struct("<HI")
"""channel, length of the entries of 16 bytes each"""
# Comparing with an enumeration's members is slow, and a long session has a million records.
_MESSAGE_INDEX = int(Opcode.MESSAGE_INDEX)
_DATA_END = int(Opcode.DATA_END)
_CHUNK_RECORDS = (int(Opcode.CHUNK), _MESSAGE_INDEX)
_KNOWN_OPCODES = frozenset(int(opcode) for opcode in Opcode)


@dataclass
class ScannedSession:
    """What a walk found. Offsets are bytes from the start of the file."""

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    metadata_indexes: list[MetadataIndex] = field(default_factory=list)
    chunks: list[ChunkIndex] = field(default_factory=list)
    message_counts: dict[int, int] = field(default_factory=dict)
    """channel id -> messages, as far as the message indexes tell"""
    whole_until: int = 0
    """end of the last whole record of the data section: what lies behind it is a cut-off record or the summary"""
    last_chunk_sealed: bool = True
    """something whole follows the last chunk's message indexes, so that none of them can be missing"""
    finished: bool = False
    """the file ends as it should: end of data, summary, footer, magic"""
    problem: str = ""
    """where and why the walk ended before a footer; empty for a finished file"""


def scan_session(stream: BinaryIO, size: int) -> ScannedSession:
    """Walk over the first `size` bytes of `stream`.

    Never raises for what the bytes hold: the result says how far they are whole, and why not further.
    """
    found = ScannedSession()
    stream.seek(0)
    if stream.read(len(MAGIC)) != MAGIC:
        found.problem = "it does not begin as an MCAP file"
        return found
    offset = found.whole_until = len(MAGIC)
    in_data = True
    while True:
        head = stream.read(_HEAD.size)
        if len(head) < _HEAD.size:
            found.problem = f"cut off at byte {size}, before its index"
            return found
        opcode, length = _HEAD.unpack(head)
        end = offset + _HEAD.size + length
        if opcode not in _KNOWN_OPCODES:
            found.problem = f"damaged at byte {offset}: no record begins with {opcode:#04x}"
            return found
        if end > size:
            name = Opcode(opcode).name.lower()
            found.problem = f"cut off at byte {size}, inside a {name} that begins at byte {offset}"
            return found
        try:
            in_data = in_data and opcode != _DATA_END
            if in_data:
                _take(found, stream, opcode, offset, length)
            elif opcode == Opcode.FOOTER:
                stream.seek(end)
                found.finished = stream.read(len(MAGIC)) == MAGIC
                found.problem = "" if found.finished else f"cut off at byte {size}, inside its closing magic"
                return found
        except (EndOfFile, struct.error, UnicodeDecodeError, ValueError):
            found.problem = f"damaged at byte {offset}: its {Opcode(opcode).name.lower()} contradicts itself"
            return found
        offset = end
        if in_data:
            found.whole_until = end
            found.last_chunk_sealed = opcode not in _CHUNK_RECORDS
        else:
            found.last_chunk_sealed = True
        stream.seek(end)


def _take(found: ScannedSession, stream: BinaryIO, opcode: int, offset: int, length: int) -> None:
    """Take what one record of the data section tells; the stream stands at its content."""
    if opcode == _MESSAGE_INDEX:
        channel_id, entries_length = _MESSAGE_INDEX_HEAD.unpack(stream.read(_MESSAGE_INDEX_HEAD.size))
        if _MESSAGE_INDEX_HEAD.size + entries_length != length:
            raise ValueError("content and length differ")
        if found.chunks:
            chunk = found.chunks[-1]
            chunk.message_index_offsets[channel_id] = offset
            chunk.message_index_length += _HEAD.size + length
        found.message_counts[channel_id] = found.message_counts.get(channel_id, 0) + entries_length // 16
        return
    if opcode == Opcode.CHUNK:
        found.chunks.append(_chunk_index(stream.read(min(length, 512)), offset, length))
        return
    if opcode not in (Opcode.SCHEMA, Opcode.CHANNEL, Opcode.METADATA):
        return
    content = ReadDataStream(BytesIO(stream.read(length)))
    if opcode == Opcode.SCHEMA:
        schema = Schema.read(content)
        found.schemas[schema.id] = schema
    elif opcode == Opcode.CHANNEL:
        channel = Channel.read(content)
        found.channels[channel.id] = channel
    else:
        metadata = Metadata.read(content)
        found.metadata[metadata.name] = metadata.metadata
        found.metadata_indexes.append(MetadataIndex(offset=offset, length=_HEAD.size + length, name=metadata.name))
    if content.count != length:
        raise ValueError("content and length differ")


def _chunk_index(head: bytes, offset: int, length: int) -> ChunkIndex:
    start_ns, end_ns, uncompressed_size, _, name_length = _CHUNK_HEAD.unpack_from(head)
    name = head[_CHUNK_HEAD.size : _CHUNK_HEAD.size + name_length].decode()
    (compressed_size,) = struct.unpack_from("<Q", head, _CHUNK_HEAD.size + name_length)
    if _CHUNK_HEAD.size + name_length + 8 + compressed_size != length:
        raise ValueError("content and length differ")
    return ChunkIndex(
        chunk_length=_HEAD.size + length,
        chunk_start_offset=offset,
        compression=name,
        compressed_size=compressed_size,
        message_end_time=end_ns,
        message_index_length=0,
        message_index_offsets={},
        message_start_time=start_ns,
        uncompressed_size=uncompressed_size,
    )


def read_footer(stream: BinaryIO, size: int) -> Footer | None:
    """The footer of a file that ends as it should; None for any other."""
    length = _HEAD.size + 20 + len(MAGIC)
    if size < len(MAGIC) + length:
        return None
    stream.seek(size - length)
    tail = stream.read(length)
    if tail[-len(MAGIC) :] != MAGIC or _HEAD.unpack_from(tail) != (Opcode.FOOTER, 20):
        return None
    summary_start, summary_offset_start, crc = struct.unpack_from("<QQI", tail, _HEAD.size)
    return Footer(summary_start=summary_start, summary_offset_start=summary_offset_start, summary_crc=crc)


def summary_is_whole(stream: BinaryIO, footer: Footer, size: int) -> bool:
    """Whether the summary has the checksum that its footer names; true where the footer names none."""
    if footer.summary_crc == 0:
        return True
    end = size - len(MAGIC) - 4
    if not 0 < footer.summary_start <= end:
        return False
    stream.seek(footer.summary_start)
    return zlib.crc32(stream.read(end - footer.summary_start)) == footer.summary_crc
