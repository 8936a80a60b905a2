# SPDX-License-Identifier: Apache-2.0
"""The end of an MCAP file: what lets a reader seek in it. Source: https://mcap.dev/spec#summary-section"""

import struct
import zlib
from collections.abc import Iterable

from mcap.opcode import Opcode
from mcap.records import DataEnd, Footer, McapRecord, Statistics, SummaryOffset

from services.recorder.chunk import record_bytes
from services.runtime.session_scan import MAGIC, ScannedSession


def closing_bytes(session: ScannedSession) -> bytes:
    """Everything behind the data section, which ends at `session.whole_until`: data end, summary, footer, magic."""
    data_end = record_bytes(DataEnd(data_section_crc=0))
    start = position = session.whole_until + len(data_end)
    groups: list[tuple[Opcode, Iterable[McapRecord]]] = [
        (Opcode.SCHEMA, session.schemas.values()),
        (Opcode.CHANNEL, session.channels.values()),
        (Opcode.STATISTICS, [_statistics(session)]),
        (Opcode.CHUNK_INDEX, session.chunks),
        (Opcode.METADATA_INDEX, session.metadata_indexes),
    ]
    parts: list[bytes] = []
    offsets: list[SummaryOffset] = []
    for opcode, records in groups:
        part = record_bytes(*records)
        if part:
            offsets.append(SummaryOffset(opcode, position, len(part)))
            parts.append(part)
            position += len(part)
    summary = b"".join([*parts, record_bytes(*offsets)])
    crc = zlib.crc32(struct.pack("<BQQQ", Opcode.FOOTER, 20, start, position), zlib.crc32(summary))
    footer = record_bytes(Footer(summary_start=start, summary_offset_start=position, summary_crc=crc))
    return data_end + summary + footer + MAGIC


def _statistics(session: ScannedSession) -> Statistics:
    return Statistics(
        attachment_count=0,
        channel_count=len(session.channels),
        channel_message_counts=dict(sorted(session.message_counts.items())),
        chunk_count=len(session.chunks),
        message_count=sum(session.message_counts.values()),
        metadata_count=len(session.metadata_indexes),
        message_start_time=min((chunk.message_start_time for chunk in session.chunks), default=0),
        message_end_time=max((chunk.message_end_time for chunk in session.chunks), default=0),
        schema_count=len(session.schemas),
    )
