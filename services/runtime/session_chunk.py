# SPDX-License-Identifier: Apache-2.0
"""Reads the pieces of an MCAP file that may be damaged: a chunk, and where its messages lie."""

import struct
from io import BytesIO
from typing import BinaryIO

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Chunk, ChunkIndex, McapRecord, MessageIndex
from mcap.stream_reader import CRCValidationError, breakup_chunk

from services.runtime.errors import KinemapError
from services.runtime.session_scan import RECORD_HEAD_BYTES

DAMAGE = (
    McapError,
    CRCValidationError,
    zstandard.ZstdError,
    RuntimeError,
    ValueError,
    EOFError,
    MemoryError,
    OverflowError,
    OSError,
    struct.error,
)
"""what reading bytes that are not those that were written can end in"""


class DamagedChunkError(KinemapError):
    """A chunk's bytes are not those that were written."""


def read_chunk(stream: BinaryIO, chunk: ChunkIndex) -> list[McapRecord]:
    """The records of one chunk, its checksum compared. Raises DamagedChunkError."""
    try:
        stream.seek(chunk.chunk_start_offset + RECORD_HEAD_BYTES)
        return breakup_chunk(Chunk.read(ReadDataStream(stream)), validate_crc=True)
    except DAMAGE as error:
        raise DamagedChunkError(str(error) or type(error).__name__) from error


def indexed_times(stream: BinaryIO, chunk: ChunkIndex, channel_id: int) -> list[int] | None:
    """Capture times of a channel's messages in the order they lie in the chunk; None where their index is damaged."""
    try:
        stream.seek(chunk.message_index_offsets[channel_id])
        head = stream.read(RECORD_HEAD_BYTES)
        index = MessageIndex.read(ReadDataStream(BytesIO(stream.read(chunk.message_index_length))))
    except DAMAGE:
        return None
    if head[:1] != bytes([Opcode.MESSAGE_INDEX]) or index.channel_id != channel_id:
        return None
    return [time_ns for time_ns, _ in sorted(index.records, key=lambda entry: entry[1])]
