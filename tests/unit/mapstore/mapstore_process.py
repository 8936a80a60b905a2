# SPDX-License-Identifier: Apache-2.0
"""A mapstore that is fed a drive: in this process, or as one that kills itself at a chosen moment.

`python -m tests.unit.mapstore.mapstore_process OUT FRAMES statement:N` is gone before its N-th SQL statement,
`... commit:N` after the N-th frame is in the file and before anybody hears of it.
"""

import os
import signal
import sys
from dataclasses import replace
from pathlib import Path

from schemas import topics
from schemas.codec import encode
from schemas.records import EndOfInput, FrameManifest, MappedObjects, MapUpdate
from schemas.topics import Topic
from services.mapstore.service import MapstoreService
from services.runtime.config import Config, load_config
from services.runtime.envelope import Envelope
from services.runtime.fake_bus import FakeBus, FakeNetwork
from services.runtime.outbox import Outbox
from services.runtime.service_loop import FrameLoop
from tests.unit.mapstore.street_map import FRAME_NS, drive, tracked, waiting, with_keyframes

SESSION = "drive"
WAITING_FRAMES = 2


def config_of(out: Path, **mapstore: object) -> Config:
    return load_config(None, {"run": {"out": str(out), "session": SESSION}, "mapstore": {"http_port": 0, **mapstore}})


class FedMapstore:
    """The service in its loop on a bus of its own."""

    def __init__(self, config: Config) -> None:
        network = FakeNetwork()
        self._bus = FakeBus(network)
        self.heard = FakeBus(network).subscribe((topics.DENSITY, topics.ANSWER))
        self.service = MapstoreService(config)
        outbox = Outbox(2 * config.delivery.window, config.run.out / "state" / "mapstore")
        self.loop = FrameLoop(self.service, self._bus, config.delivery, SESSION, outbox)

    def feed(self, frames: int) -> dict[int, bytes]:
        """Sends the whole drive, done or not, and its end. Returns the density messages by sequence number."""
        for sequence in range(frames):
            self.send(sequence)
        envelope = Envelope(SESSION, frames, frames * FRAME_NS)
        self.publish(topics.MAP_UPDATE, with_keyframes(MapUpdate(frames * FRAME_NS, 1, True), 0, y=0.25), envelope)
        self.publish(topics.END, EndOfInput(envelope.timestamp_ns, frames), envelope)
        densities: dict[int, bytes] = {}
        self.answers: list[int] = []
        while self.loop.step(0.0):
            pass
        while (message := self.heard.receive(0.0)) is not None:
            if message.topic is topics.DENSITY:
                densities[message.envelope.sequence] = message.payload
            else:
                self.answers.append(message.envelope.sequence)
        return densities

    def send(self, sequence: int) -> None:
        """One frame as the camera and slam send it."""
        frame, update = list(drive(sequence + 1))[-1]
        if sequence < WAITING_FRAMES:
            frame, update = waiting(sequence), MapUpdate(sequence * FRAME_NS)
        elif sequence < 2 * WAITING_FRAMES:
            frame = replace(tracked(sequence, 0, float(sequence)), reference_keyframe_id=frame.reference_keyframe_id)
        envelope = Envelope(SESSION, sequence, frame.timestamp_ns)
        self.publish(topics.MANIFEST, FrameManifest(frame.timestamp_ns, "test", str(sequence), ()), envelope)
        self.publish(topics.MAP_UPDATE, update, envelope)
        self.publish(topics.MAPPED_OBJECTS, MappedObjects(frame.timestamp_ns, frame.map_id, True), envelope)
        self.publish(topics.TRACKED_FRAME, frame, envelope)

    def publish(self, topic: Topic, record: object, envelope: Envelope) -> None:
        self._bus.publish(topic, encode(topic, record), envelope)

    def close(self) -> None:
        self.service.close()


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def arm(service: MapstoreService, moment: str) -> None:
    """Sets the moment of death."""
    kind, number = moment.split(":")
    left = int(number)

    def count(*_: object) -> None:
        nonlocal left
        left -= 1
        if left == 0:
            die()

    store = service._store
    if kind == "statement":
        store._connection.set_trace_callback(count)
        return
    put = store.put

    def put_and_count(*frame: object) -> None:
        put(*frame)
        count()

    store.put = put_and_count


if __name__ == "__main__":
    fed = FedMapstore(config_of(Path(sys.argv[1]), serve_http=False))
    arm(fed.service, sys.argv[3])
    fed.feed(int(sys.argv[2]))
