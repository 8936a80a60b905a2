# SPDX-License-Identifier: Apache-2.0
"""MCAP files: kinemap's own sessions, ROS 2's and Foxglove's recordings."""

from pathlib import Path
from typing import NamedTuple

from mcap.reader import make_reader
from mcap.records import Header
from mcap.summary import Summary

from schemas import topics as kinemap_topics
from services.camera.sources.recordings.foxglove_log import FoxgloveLog
from services.camera.sources.recordings.mcap_session import McapSession
from services.camera.sources.recordings.message_source import MessageSource
from services.camera.sources.recordings.message_topics import TopicOptions
from services.camera.sources.source import Source
from services.runtime.errors import InputError
from services.runtime.session_scan import MAGIC

_OWN_LIBRARY = "kinemap"
_ROS_2_ENCODING = "cdr"
_KNOWN_ENCODINGS = {_ROS_2_ENCODING, "protobuf"}


class _Head(NamedTuple):
    """What the file tells of itself; `summary` is None for one that was cut off."""

    library: str
    summary: Summary | None


def open_mcap(path: Path, topics: TopicOptions, *, calibration: Path | None = None) -> Source:
    """The camera of an MCAP file: a session of kinemap's is driven again; of others the image topic is read.

    Raises:
        InputError: no MCAP, cut off, or without images that can be used.
    """
    head = _read_head(path)
    if head is None or _is_session(head):
        return McapSession(path)
    if head.summary is None:
        raise InputError(f"{path}: cut off or without an index, expected a whole MCAP file; `mcap recover` makes one")
    encodings = {channel.message_encoding for channel in head.summary.channels.values()}
    if encodings and not encodings & _KNOWN_ENCODINGS:
        found = ", ".join(sorted(encodings))
        raise InputError(f"{path}: messages encoded as {found}, expected cdr (ROS 2) or protobuf (Foxglove)")
    beside = (path.with_suffix(".toml"), path.parent / "calibration.toml")
    if _ROS_2_ENCODING in encodings:
        from services.camera.sources.recordings.ros_bag import RosBag

        return MessageSource(RosBag(path), topics, calibration=calibration, beside=beside)
    return MessageSource(FoxgloveLog(path), topics, calibration=calibration, beside=beside)


def _read_head(path: Path) -> _Head | None:
    """None for what is no MCAP file."""
    with path.open("rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            return None
        stream.seek(0)
        try:
            reader = make_reader(stream)
            header: Header = reader.get_header()
        except Exception:  # mcap meets damage with whatever it stumbles over
            return None
        try:
            return _Head(header.library, reader.get_summary())
        except Exception:
            return _Head(header.library, None)


def _is_session(head: _Head) -> bool:
    if head.library.startswith(_OWN_LIBRARY):
        return True
    channels = head.summary.channels.values() if head.summary is not None else ()
    return any(channel.topic == kinemap_topics.MANIFEST.key for channel in channels)
