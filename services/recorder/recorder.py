# SPDX-License-Identifier: Apache-2.0
"""From the bus to the file: each frame is written whole, once, and answered when it is on disk."""

import time
from pathlib import Path

from schemas import topics
from schemas.codec import encode
from schemas.records import FrameAnswer
from services.recorder.frame_ledger import FrameLedger, ReleasedFrame
from services.recorder.session_writer import SessionWriter
from services.runtime.bus import Bus
from services.runtime.envelope import Envelope
from services.runtime.errors import ProtocolError
from services.runtime.log import get_logger
from services.runtime.metrics import Metrics

NAME = "recorder"
_LAST_SEQUENCE = 2**32 - 1
"""MCAP holds a sequence number in 32 bits, a time without a sign"""
RECORDED_TOPICS = tuple(topic for topic in topics.TOPICS if topic.recorded)


class Recorder:
    """Records one session from one bus. Its answer means: all messages of this frame outlive a kill of this process."""

    def __init__(self, writer: SessionWriter, ledger: FrameLedger, bus: Bus, session: str) -> None:
        self._writer = writer
        self._ledger = ledger
        self._bus = bus
        self._session = session
        self._log = get_logger(NAME)
        self.metrics_of_frames = Metrics()
        self.ended = False
        self._subscription = bus.subscribe((*RECORDED_TOPICS, topics.ANSWER))
        if writer.recovered:
            self._log.info("resumed", sequence=ledger.last_sequence, bytes=writer.size, file=writer.path)

    @property
    def path(self) -> Path:
        """The session's file."""
        return self._writer.path

    @property
    def sequence(self) -> int:
        """The last frame on disk, -1 for none."""
        return self._ledger.last_sequence

    def step(self, timeout_s: float) -> bool:
        """Handle one message if one comes within `timeout_s`; false when none did.

        Raises:
            ResourceError: the disk is full or fails; the file was closed and stays readable.
        """
        message = self._subscription.receive(timeout_s)
        if message is None:
            return False
        if message.envelope.session != self._session:
            self.metrics_of_frames.count("other_session")
        elif not (0 <= message.envelope.sequence <= _LAST_SEQUENCE and message.envelope.timestamp_ns >= 0):
            self.metrics_of_frames.count("messages_unreadable")
            self._log.warning_limited("message_unreadable", envelope=message.envelope)
        elif message.topic is not topics.ANSWER or message.suffix != NAME:
            try:
                for frame in self._ledger.add(message):
                    self._take(frame)
            except ProtocolError as error:
                self.metrics_of_frames.count("messages_unreadable")
                self._log.warning_limited("message_unreadable", error=error)
        return True

    def metrics(self) -> dict[str, float]:
        """Numbers for the heartbeat."""
        counts = {f"recorder_{name}": float(count) for name, count in self._ledger.counts.copy().items()}
        sizes = {"bytes": float(self._writer.size), "messages": float(self._writer.message_count)}
        return {**self.metrics_of_frames.values(), **counts, **sizes}

    def close(self) -> None:
        """Write what still waits (realtime) and the index. A later recorder of this session goes on behind it."""
        try:
            for frame in self._ledger.drain():
                self._write(frame)
            self._writer.finish()
        finally:
            self._writer.close()

    def _take(self, frame: ReleasedFrame) -> None:
        if frame.messages:
            self._write(frame)
        if frame.ends:
            self._writer.finish()
            self.ended = True
        self._answer(frame.envelope)

    def _write(self, frame: ReleasedFrame) -> None:
        started = time.perf_counter()
        self._writer.append(frame.messages)
        self.metrics_of_frames.observe_ms("process", (time.perf_counter() - started) * 1e3)
        self.metrics_of_frames.count("frames")

    def _answer(self, envelope: Envelope) -> None:
        answer = FrameAnswer(envelope.timestamp_ns, NAME)
        self._bus.publish(topics.ANSWER, encode(topics.ANSWER, answer), envelope, NAME)
