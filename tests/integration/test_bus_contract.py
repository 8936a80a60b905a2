# SPDX-License-Identifier: Apache-2.0
"""What every bus must keep, held against the fake one and against zenoh."""

import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from schemas import topics
from services.runtime.bus import Bus
from services.runtime.config.bus import BusConfig
from services.runtime.envelope import Envelope
from services.runtime.fake_bus import FakeBus, FakeNetwork
from services.runtime.zenoh_bus import ZenohBus, open_session

BusFactory = Callable[[], Bus]
WAIT_S = 20.0


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture(params=["fake", "zenoh"])
def new_bus(request: pytest.FixtureRequest) -> Iterator[BusFactory]:
    with ExitStack() as stack:
        if request.param == "fake":
            network = FakeNetwork()
            yield lambda: stack.enter_context(FakeBus(network))
        else:
            config = BusConfig(entry_point=f"tcp/127.0.0.1:{free_port()}")
            stack.enter_context(open_session(config, listen=config.entry_point, connect=False))
            yield lambda: stack.enter_context(ZenohBus(config, lossless=True))


def wait_until_alive(bus: Bus, name: str) -> None:
    seen = threading.Event()
    bus.watch_alive(lambda other, alive: seen.set() if other == name and alive else None)
    assert seen.wait(WAIT_S), f"{name} never showed up"


def test_messages_arrive_in_order_with_their_envelope(new_bus: BusFactory) -> None:
    sender, receiver = new_bus(), new_bus()
    subscription = receiver.subscribe([topics.IMAGE, topics.OBJECTS])
    receiver.declare_alive("receiver")
    wait_until_alive(sender, "receiver")
    sent = [Envelope("s", n, n * 100) for n in range(50)]
    for envelope in sent:
        sender.publish(topics.IMAGE if envelope.sequence % 2 else topics.OBJECTS, b"x" * 5000, envelope)
    received = [subscription.receive(WAIT_S) for _ in sent]
    for topic, parity in ((topics.OBJECTS, 0), (topics.IMAGE, 1)):
        heard = [message.envelope for message in received if message and message.topic is topic]
        assert heard == sent[parity::2]
    assert received[0] is not None
    assert received[0].payload == b"x" * 5000


def test_a_suffix_names_the_sender(new_bus: BusFactory) -> None:
    sender, receiver = new_bus(), new_bus()
    subscription = receiver.subscribe([topics.ANSWER])
    receiver.declare_alive("receiver")
    wait_until_alive(sender, "receiver")
    sender.publish(topics.ANSWER, b"a", Envelope("s", 1, 2), "slam")
    message = subscription.receive(WAIT_S)
    assert message is not None
    assert message.suffix == "slam"


def test_what_is_not_subscribed_is_not_heard(new_bus: BusFactory) -> None:
    sender, receiver = new_bus(), new_bus()
    subscription = receiver.subscribe([topics.IMAGE])
    receiver.declare_alive("receiver")
    wait_until_alive(sender, "receiver")
    sender.publish(topics.DENSITY, b"no", Envelope("s", 0, 0))
    sender.publish(topics.IMAGE, b"yes", Envelope("s", 1, 1))
    message = subscription.receive(WAIT_S)
    assert message is not None
    assert message.payload == b"yes"
    assert subscription.receive(0.0) is None


def test_whoever_leaves_is_seen_to_go(new_bus: BusFactory) -> None:
    watcher, other = new_bus(), new_bus()
    came, went = threading.Event(), threading.Event()
    watcher.watch_alive(lambda name, alive: (came if alive else went).set() if name == "other" else None)
    other.declare_alive("other")
    assert came.wait(WAIT_S)
    other.close()
    assert went.wait(WAIT_S)


def test_a_ring_keeps_the_newest(new_bus: BusFactory) -> None:
    sender, receiver = new_bus(), new_bus()
    ring = receiver.subscribe([topics.IMAGE], keep_all=False)
    receiver.declare_alive("receiver")
    wait_until_alive(sender, "receiver")
    for n in range(20):
        sender.publish(topics.IMAGE, bytes([n]), Envelope("s", n, n))
    deadline = time.monotonic() + WAIT_S
    while ring.drop_counts().get(topics.IMAGE.key, 0) < 20 - topics.IMAGE.queue_depth:
        assert time.monotonic() < deadline, f"only {ring.drop_counts()} dropped"
        threading.Event().wait(0.01)  # another thread feeds the ring, when the scheduler lets it
    heard = [message.envelope.sequence for message in iter(lambda: ring.receive(0.0), None)]
    assert heard == list(range(20 - topics.IMAGE.queue_depth, 20))


def test_a_closed_subscription_hears_no_more(new_bus: BusFactory) -> None:
    sender, receiver = new_bus(), new_bus()
    subscription = receiver.subscribe([topics.IMAGE])
    subscription.close()
    sender.publish(topics.IMAGE, b"late", Envelope("s", 0, 0))
    assert subscription.receive(0.2) is None
