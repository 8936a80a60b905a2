# SPDX-License-Identifier: Apache-2.0
"""The bus as services see it: publish, subscribe, say that one lives. zenoh_bus and fake_bus keep this contract."""

from collections.abc import Callable, Iterable
from typing import NamedTuple, Protocol, Self

from schemas.topics import Topic
from services.runtime.envelope import Envelope


class Message(NamedTuple):
    """One message as it was received; `payload` is not decoded yet."""

    topic: Topic
    envelope: Envelope
    payload: bytes
    suffix: str = ""


class Subscription(Protocol):
    """A queue of messages."""

    def receive(self, timeout_s: float) -> Message | None:
        """The oldest message, or None when none came within `timeout_s`."""

    def frame_times_ns(self) -> set[int]:
        """Capture times of the frames that messages wait of."""

    def drop_counts(self) -> dict[str, int]:
        """How many messages a full queue has dropped, by topic, and how many were not readable."""

    def close(self) -> None:
        """Hear no more."""


class Bus(Protocol):
    """Messages of one publisher on one topic arrive in the order they were sent. Any thread may call any method."""

    def publish(self, topic: Topic, payload: bytes, envelope: Envelope, suffix: str = "") -> None:
        """Send; never waits for a slow subscriber longer than the transport's own buffer lasts."""

    def subscribe(self, topics: Iterable[Topic], *, keep_all: bool = True) -> Subscription:
        """Hear `topics` from now on. `keep_all` false: each topic's queue keeps its `queue_depth` newest messages."""

    def declare_alive(self, name: str) -> None:
        """Tell the others that `name` is ready, until this bus is closed or the process dies."""

    def watch_alive(self, on_change: Callable[[str, bool], None]) -> None:
        """Call `on_change(name, alive)` for everyone who is there already and for each who comes or goes."""

    def close(self) -> None:
        """Leave the bus; subscriptions end, the others see this one go."""

    def __enter__(self) -> Self: ...

    def __exit__(self, *exception: object) -> None: ...
