# SPDX-License-Identifier: Apache-2.0
"""Messages to the bytes of one MCAP chunk with its message indexes. Source: https://mcap.dev/spec#chunk-op0x06"""

import zlib
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.records import Chunk, ChunkIndex, McapRecord, Message, MessageIndex

from services.runtime.session_file import RecordedMessage


class EncodedChunk(NamedTuple):
    """The bytes to write, and what the file's index will say of them."""

    data: bytes
    index_record: ChunkIndex
    message_counts: dict[int, int]


def record_bytes(*records: McapRecord) -> bytes:
    """The records one behind the other, as they stand in a file."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data


def encode_chunk(
    messages: Sequence[RecordedMessage], channel_ids: Mapping[str, int], offset: int, zstd_level: int
) -> EncodedChunk:
    """One chunk of all `messages`, in their order, that will stand at byte `offset` of its file.

    Both of a message's times are its capture time; its sequence is its envelope's. `zstd_level` 0: not compressed.
    """
    parts: list[bytes] = []
    size = 0
    indexes: dict[int, MessageIndex] = {}
    for key, sequence, time_ns, payload in messages:
        channel_id = channel_ids[key]
        indexes.setdefault(channel_id, MessageIndex(channel_id, [])).records.append((time_ns, size))
        parts.append(record_bytes(Message(channel_id, time_ns, payload, time_ns, sequence)))
        size += len(parts[-1])
    plain = b"".join(parts)
    packed = zstandard.ZstdCompressor(level=zstd_level).compress(plain) if zstd_level else plain
    compression = "zstd" if zstd_level else ""
    start_ns = min(message.timestamp_ns for message in messages)
    end_ns = max(message.timestamp_ns for message in messages)
    chunk = record_bytes(Chunk(compression, packed, end_ns, start_ns, zlib.crc32(plain), size))
    index_parts: list[bytes] = []
    index_offsets: dict[int, int] = {}
    index_length = 0
    for channel_id, index in indexes.items():
        index_offsets[channel_id] = offset + len(chunk) + index_length
        index_parts.append(record_bytes(index))
        index_length += len(index_parts[-1])
    index_record = ChunkIndex(
        chunk_length=len(chunk),
        chunk_start_offset=offset,
        compression=compression,
        compressed_size=len(packed),
        message_end_time=end_ns,
        message_index_length=index_length,
        message_index_offsets=index_offsets,
        message_start_time=start_ns,
        uncompressed_size=size,
    )
    counts = {channel_id: len(index.records) for channel_id, index in indexes.items()}
    return EncodedChunk(b"".join([chunk, *index_parts]), index_record, counts)
