# SPDX-License-Identifier: Apache-2.0
"""A recorded session back onto the bus, byte for byte."""

from collections.abc import Callable, Collection

from services.recorder.recorded_key import topic_and_suffix
from services.recorder.replay_pace import Pace
from services.runtime.bus import Bus
from services.runtime.envelope import Envelope
from services.runtime.session_file import RecordedMessage, SessionFile


class Replayer:
    """Publishes a session's messages as they were recorded: same bytes, sequence and capture time.

    Args:
        session: the session id they travel under; the recorded one when empty.
    """

    def __init__(self, file: SessionFile, bus: Bus, session: str = "") -> None:
        self._file = file
        self._bus = bus
        self._session = session or file.session

    def play(
        self,
        pace: Pace,
        keys: Collection[str] | None = None,
        on_message: Callable[[RecordedMessage], None] | None = None,
    ) -> int:
        """Publish all messages, or those of `keys`, each when `pace` lets it. Returns how many went out.

        Raises:
            InputError: a damaged chunk, or a recorded topic that kinemap does not know.
            KinemapError: whoever has to answer does not.
        """
        count = 0
        for message in self._file.messages(keys):
            topic, suffix = topic_and_suffix(message.key)
            if not pace.await_turn(message):
                break
            envelope = Envelope(self._session, message.sequence, message.timestamp_ns)
            self._bus.publish(topic, message.payload, envelope, suffix)
            count += 1
            if on_message is not None:
                on_message(message)
        return count
