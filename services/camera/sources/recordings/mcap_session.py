# SPDX-License-Identifier: Apache-2.0
"""The camera of a recorded session, so that the pipeline runs again on what it saw then."""

from pathlib import Path
from typing import Any

from schemas import topics
from schemas.codec import decode
from schemas.topics import BY_KEY
from services.camera.sources.source import SourceFrame
from services.runtime.errors import InputError, ProtocolError
from services.runtime.session_file import IndexedMessage, RecordedMessage, SessionFile

_CAMERA_KEYS = frozenset(topic.key for topic in topics.TOPICS if topic.producer == "camera" and topic.per_frame)


class McapSession:
    """The frames of a session under their recorded names and capture times, read one by one.

    Raises:
        InputError: not a session, cut off (without `recover`), without a camera's frames, or a frame that is damaged.
    """

    def __init__(self, path: Path, recover: bool = False) -> None:
        self._path = path
        self._file = SessionFile(path, recover)
        try:
            self._frames = self._file.index_of(topics.MANIFEST.key)
            if not self._frames:
                raise InputError(f"{path}: holds no camera frames; it records {list(self._file.message_counts())}")
            self._check_times()
            self._first = decode(topics.MANIFEST, self._file.at(self._frames[0]).payload)
        except BaseException:
            self._file.close()
            raise

    @property
    def name(self) -> str:
        """The session's file."""
        return str(self._path)

    @property
    def frame_count(self) -> int:
        """Frames in the session."""
        return len(self._frames)

    @property
    def rate_hz(self) -> float:
        """As the recorded camera said."""
        return float(self._first.rate_hz)

    @property
    def notes(self) -> tuple[str, ...]:
        """That the session had to be recovered, where it had to."""
        why = self._file.recovered
        return (f"{self._path}: {why}; {self.frame_count} whole frames are used",) if why else ()

    def frame(self, index: int) -> SourceFrame | None:
        """Frame `index` of the session, None past its end. Raises InputError when it is damaged or incomplete."""
        if index >= len(self._frames):
            return None
        place = self._frames[index]
        manifest_message = self._file.at(place)
        try:
            manifest = decode(topics.MANIFEST, manifest_message.payload)
            listed = _CAMERA_KEYS.intersection(manifest.topics)
            records = {
                message.key: decode(BY_KEY[message.key], message.payload)
                for message in self._messages(place, manifest_message.sequence, listed)
            }
        except ProtocolError as error:
            raise InputError(f"{self._path}: frame {index}: {error}") from error
        if listed - records.keys():
            raise InputError(f"{self._path}: frame {index} lacks {', '.join(sorted(listed - records.keys()))}")
        return self._as_frame(manifest.frame_name, place.timestamp_ns, records)

    def close(self) -> None:
        """Close the session's file."""
        self._file.close()

    def _messages(self, place: IndexedMessage, sequence: int, listed: frozenset[str]) -> list[RecordedMessage]:
        def wanted(message: RecordedMessage) -> bool:
            return message.key in listed and message.sequence == sequence

        messages = [message for message in self._file.beside(place) if wanted(message)]
        if {message.key for message in messages} != listed:
            # A realtime recording may hold a late message of this frame in a later chunk.
            time_ns = place.timestamp_ns
            messages = [message for message in self._file.messages(listed, time_ns, time_ns) if wanted(message)]
        return messages

    def _as_frame(self, name: str, timestamp_ns: int, records: dict[str, Any]) -> SourceFrame:
        for needed in (topics.IMAGE, topics.CALIBRATION):
            if needed.key not in records:
                raise InputError(f"{self._path}: frame {name} was recorded without {needed.key}")
        return SourceFrame(
            name=name,
            timestamp_ns=timestamp_ns,
            image=records[topics.IMAGE.key],
            calibration=records[topics.CALIBRATION.key],
            image_right=records.get(topics.IMAGE_RIGHT.key),
            calibration_right=records.get(topics.CALIBRATION_RIGHT.key),
            depth=records.get(topics.DEPTH.key),
            true_pose=records.get(topics.TRUE_POSE.key),
            true_instances=records.get(topics.TRUE_INSTANCES.key),
        )

    def _check_times(self) -> None:
        for before, after in zip(self._frames, self._frames[1:], strict=False):
            if after.timestamp_ns <= before.timestamp_ns:
                raise InputError(
                    f"{self._path}: a frame of time {after.timestamp_ns} ns follows one of {before.timestamp_ns} ns; "
                    "expected times that increase"
                )
