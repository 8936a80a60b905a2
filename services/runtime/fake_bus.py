# SPDX-License-Identifier: Apache-2.0
"""The bus within one process, for tests: the same contract as zenoh_bus, no sockets, no threads."""

import threading
from collections.abc import Callable, Iterable
from typing import Self

from schemas.topics import Topic
from services.runtime.bus import Message
from services.runtime.envelope import Envelope
from services.runtime.inbound_queue import InboundQueue


class FakeNetwork:
    """What several FakeBus share."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.queues: list[tuple[frozenset[Topic], InboundQueue]] = []
        self.alive: dict[str, FakeBus] = {}
        self.watchers: list[Callable[[str, bool], None]] = []


class FakeBus:
    """One service's access to a FakeNetwork."""

    def __init__(self, network: FakeNetwork) -> None:
        self._network = network
        self._own: list[InboundQueue] = []

    def publish(self, topic: Topic, payload: bytes, envelope: Envelope, suffix: str = "") -> None:
        """Hand the message to every subscriber at once."""
        with self._network.lock:
            for topics, queue in self._network.queues:
                if topic in topics:
                    queue.put(Message(topic, envelope, payload, suffix))

    def subscribe(self, topics: Iterable[Topic], *, keep_all: bool = True) -> InboundQueue:
        """Hear `topics` from now on."""
        queue = InboundQueue(keep_all=keep_all)
        with self._network.lock:
            self._network.queues.append((frozenset(topics), queue))
        self._own.append(queue)
        return queue

    def declare_alive(self, name: str) -> None:
        """Tell the others that `name` is ready."""
        with self._network.lock:
            self._network.alive[name] = self
            watchers = list(self._network.watchers)
        for watcher in watchers:
            watcher(name, True)

    def watch_alive(self, on_change: Callable[[str, bool], None]) -> None:
        """Call `on_change(name, alive)` for all who are there, and for each change."""
        with self._network.lock:
            self._network.watchers.append(on_change)
            names = list(self._network.alive)
        for name in names:
            on_change(name, True)

    def close(self) -> None:
        """Leave the network."""
        with self._network.lock:
            self._network.queues = [entry for entry in self._network.queues if entry[1] not in self._own]
            gone = [name for name, bus in self._network.alive.items() if bus is self]
            for name in gone:
                del self._network.alive[name]
            watchers = list(self._network.watchers)
        for queue in self._own:
            queue.close()
        for name in gone:
            for watcher in watchers:
                watcher(name, False)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
