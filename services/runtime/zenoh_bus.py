# SPDX-License-Identifier: Apache-2.0
"""The bus over zenoh: peers on explicit local endpoints that find each other by gossip through one entry point.

Peers each listen on a port of their own, so that the mesh outlives its entry point; nothing is multicast unless the
configuration asks for it.
"""

import json
import threading
from collections.abc import Callable, Iterable
from typing import Self

import zenoh

from schemas.topics import Topic
from services.runtime.bus import Message
from services.runtime.config.bus import BusConfig
from services.runtime.envelope import Envelope
from services.runtime.errors import KinemapError, ProtocolError, ResourceError
from services.runtime.inbound_queue import InboundQueue

_EVERY_SERVICE = "*"


def open_session(config: BusConfig, *, listen: str = "tcp/127.0.0.1:0", connect: bool = True) -> zenoh.Session:
    """A zenoh session as `config` says. Raises ResourceError when the endpoint cannot be listened on."""
    settings = zenoh.Config()
    values: dict[str, object] = {
        "mode": "client" if config.router else "peer",
        "scouting/multicast/enabled": config.multicast,
        "scouting/gossip/enabled": True,
        "connect/endpoints": [config.router or config.entry_point] if connect else [],
        "connect/timeout_ms": -1,
        "connect/exit_on_failure": False,
        "connect/retry": {"period_init_ms": 50, "period_max_ms": 500, "period_increase_factor": 1.5},
        "transport/shared_memory/enabled": config.shared_memory,
    }
    if not config.router:
        values["listen/endpoints"] = [listen]
        values["listen/exit_on_failure"] = True
    for key, value in values.items():
        settings.insert_json5(key, json.dumps(value))
    zenoh.init_log_from_env_or("off")  # what matters is raised; RUST_LOG=error shows the rest
    try:
        return zenoh.open(settings)
    except zenoh.ZError as error:
        raise ResourceError(f"bus endpoint {listen} cannot be opened, expected a free local port: {error}") from error


class ZenohSubscription:
    """The queue of one subscription and the zenoh subscribers that fill it."""

    def __init__(self, queue: InboundQueue, subscribers: list[zenoh.Subscriber[None]]) -> None:
        self._queue = queue
        self._subscribers = subscribers
        self.receive = queue.receive
        self.frame_times_ns = queue.frame_times_ns
        self.drop_counts = queue.drop_counts

    def close(self) -> None:
        """Hear no more."""
        for subscriber in self._subscribers:
            subscriber.undeclare()
        self._subscribers.clear()
        self._queue.close()


class ZenohBus:
    """One service's access to the bus. `lossless` asks zenoh to wait rather than drop when a transport is full."""

    def __init__(self, config: BusConfig, *, lossless: bool) -> None:
        self._prefix = f"kinemap/{config.robot}/"
        self._alive_prefix = f"kinemap-alive/{config.robot}/"
        self._session = open_session(config)
        self._congestion = zenoh.CongestionControl.BLOCK if lossless else zenoh.CongestionControl.DROP
        self._subscriptions: list[ZenohSubscription] = []
        self._tokens: list[zenoh.LivelinessToken] = []
        self._watchers: list[zenoh.Subscriber[None]] = []
        self._lock = threading.Lock()

    def publish(self, topic: Topic, payload: bytes, envelope: Envelope, suffix: str = "") -> None:
        """Send one message under its topic's key."""
        key = f"{self._prefix}{topic.key}/{suffix}" if suffix else f"{self._prefix}{topic.key}"
        try:
            self._session.put(key, payload, congestion_control=self._congestion, attachment=envelope.to_bytes())
        except zenoh.ZError as error:
            raise KinemapError(f"cannot publish {topic.key}: {error}") from error

    def subscribe(self, topics: Iterable[Topic], *, keep_all: bool = True) -> ZenohSubscription:
        """Hear `topics` from now on."""
        queue = InboundQueue(keep_all=keep_all)
        subscribers = [self._subscribe_one(topic, queue) for topic in topics]
        subscription = ZenohSubscription(queue, subscribers)
        self._subscriptions.append(subscription)
        return subscription

    def _subscribe_one(self, topic: Topic, queue: InboundQueue) -> zenoh.Subscriber[None]:
        base = f"{self._prefix}{topic.key}"

        def on_sample(sample: zenoh.Sample) -> None:
            suffix = str(sample.key_expr)[len(base) + 1 :]
            attachment = sample.attachment
            try:
                envelope = Envelope.from_bytes(b"" if attachment is None else attachment.to_bytes())
            except ProtocolError:
                queue.count_unreadable(topic.key)
                return
            queue.put(Message(topic, envelope, sample.payload.to_bytes(), suffix))

        key = f"{base}/*" if topic.producer == _EVERY_SERVICE else base
        return self._session.declare_subscriber(key, on_sample)

    def declare_alive(self, name: str) -> None:
        """Tell the others that `name` is ready."""
        self._tokens.append(self._session.liveliness().declare_token(self._alive_prefix + name))

    def watch_alive(self, on_change: Callable[[str, bool], None]) -> None:
        """Call `on_change(name, alive)` for all who are there, and for each change."""

        def on_token(sample: zenoh.Sample) -> None:
            on_change(str(sample.key_expr)[len(self._alive_prefix) :], sample.kind == zenoh.SampleKind.PUT)

        self._watchers.append(
            self._session.liveliness().declare_subscriber(self._alive_prefix + "*", on_token, history=True)
        )

    def close(self) -> None:
        """Leave the bus. A process that forgets this never ends: zenoh's callback threads keep it."""
        with self._lock:
            for subscription in self._subscriptions:
                subscription.close()
            self._subscriptions.clear()
            for token in self._tokens:
                token.undeclare()
            self._tokens.clear()
            for watcher in self._watchers:
                watcher.undeclare()
            self._watchers.clear()
            if not self._session.is_closed():
                self._session.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
