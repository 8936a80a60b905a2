# SPDX-License-Identifier: Apache-2.0
"""What a service that works frame by frame is: the part that a service.py fills in."""

from abc import ABC, abstractmethod
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

from schemas.topics import Topic
from services.runtime.envelope import Envelope
from services.runtime.outbox import State


class Outgoing(NamedTuple):
    """A record to send under the frame's envelope."""

    topic: Topic
    record: Any


class Bundle:
    """The decoded inputs of one frame. `missing` names what a deadline did not wait for (realtime)."""

    def __init__(self, envelope: Envelope, records: dict[Topic, Any], missing: tuple[str, ...] = ()) -> None:
        self.envelope = envelope
        self.missing = missing
        self._records = records

    @property
    def timestamp_ns(self) -> int:
        """The frame's capture time."""
        return self.envelope.timestamp_ns

    def __getitem__(self, topic: Topic) -> Any:
        return self._records[topic]

    def get(self, topic: Topic) -> Any | None:
        """The record of `topic`, or None where this frame has none."""
        return self._records.get(topic)


class FrameService(ABC):
    """One service. `process` is a deterministic function of the state and the bundle; the loop does the rest."""

    name: ClassVar[str]
    awaits: ClassVar[tuple[Topic, ...]]
    """inputs of one frame; those of the camera are awaited only when its manifest lists them"""
    final_awaits: ClassVar[tuple[Topic, ...]] = ()
    """what must have come under the end's sequence number before `finish`"""
    deferrable: ClassVar[tuple[Topic, ...]] = ()
    """inputs that a deadline does not wait for (realtime)"""
    most_pending: ClassVar[int | None] = None
    """incomplete frames held at most in `realtime`, where that is fewer than delivery.pending_bundles"""
    answers: ClassVar[bool] = False
    """whether the camera counts on this service's answer to every frame (lossless)"""

    @abstractmethod
    def process(self, bundle: Bundle) -> list[Outgoing]:
        """Do one frame."""

    def finish(self, bundle: Bundle) -> list[Outgoing]:
        """The input is over; `bundle` holds topics.END and `final_awaits`."""
        return []

    def keep_state_in(self, folder: Path) -> None:  # noqa: B027 - most keep nothing but what `snapshot` gives
        """A folder of this run and service, for state too large to be written with every frame; called once, first."""

    def snapshot(self) -> State | None:
        """All state over frames as arrays, empty before the first; None, always, for a service that has none."""
        return None

    def restore(self, state: State) -> None:  # noqa: B027 - a service without state has nothing to do
        """Take up the state of a predecessor that was killed."""

    def last_sequence(self) -> int | None:
        """The last frame done, by a service that keeps its state itself (a database)."""
        return None

    def metrics(self) -> dict[str, float]:
        """Numbers for the heartbeat."""
        return {}

    def close(self) -> None:  # noqa: B027 - nor has one without files and threads
        """Let go of files and threads."""
