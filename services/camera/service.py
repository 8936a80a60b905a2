# SPDX-License-Identifier: Apache-2.0
"""The camera service: a source's frames onto the bus, in either way to deliver."""

import time
from functools import partial

from schemas import topics
from schemas.codec import encode
from schemas.records import EndOfInput
from services.camera.configured_delivery import configured_delivery, require_realtime
from services.camera.configured_source import open_configured_source
from services.camera.delivery import Delivery, Host, Parcel
from services.camera.frame_records import frame_records
from services.camera.position import PositionFile
from services.camera.prefetch import Prefetch
from services.camera.presence import Presence
from services.camera.sources.live.live_address import is_live
from services.camera.sources.source import Source, SourceFrame
from services.runtime.bus import Bus
from services.runtime.config import Config
from services.runtime.envelope import Envelope
from services.runtime.host import ServiceHost, run_main
from services.runtime.log import get_logger
from services.runtime.metrics import Metrics
from services.runtime.zenoh_bus import ZenohBus

NAME = "camera"
_TICK_S = 0.1
_SAY_WHO_IS_MISSING_S = 10.0


class BusOutlet:
    """Encodes a source's frames and publishes them."""

    def __init__(self, source: Source, bus: Bus, session: str) -> None:
        self._source = source
        self._bus = bus
        self._session = session

    def pack(self, sequence: int, frame: SourceFrame) -> Parcel:
        """One frame's messages, the manifest first."""
        records = frame_records(frame, self._source)
        return Parcel(sequence, frame.timestamp_ns, tuple((topic, encode(topic, record)) for topic, record in records))

    def pack_end(self, frame_count: int, timestamp_ns: int) -> Parcel:
        """The end of input, under the sequence number `frame_count`."""
        end = encode(topics.END, EndOfInput(timestamp_ns, frame_count))
        return Parcel(frame_count, timestamp_ns, ((topics.END, end),))

    def send(self, parcel: Parcel) -> None:
        """Publish under the frame's envelope."""
        envelope = Envelope(self._session, parcel.sequence, parcel.timestamp_ns)
        for topic, payload in parcel.messages:
            self._bus.publish(topic, payload, envelope)


class CameraService:
    """Sends one source through, once."""

    def __init__(self, source: Source, bus: Bus, config: Config) -> None:
        require_realtime(config)
        self.metrics = Metrics()
        self._source = source
        self._config = config
        self._outlet = BusOutlet(source, bus, config.run.session)
        self._live = is_live(config.camera.input)
        self._log = get_logger(NAME)
        self._position_file = PositionFile(config.run.out / "state" / NAME / "position.json", config.run.session)
        self._answers = bus.subscribe([topics.ANSWER])
        self._presence = Presence(topics.END.consumers)
        bus.watch_alive(self._presence.changed)

    def run(self, host: Host) -> None:
        """Send everything, then return with the state `done`; earlier when `host.stopping` is set.

        Raises:
            InputError: a frame cannot be used; all that went before it has been sent and answered.
        """
        position = self._position_file.read()
        host.sequence = position.sequence
        for note in self._source.notes:
            self._log.warning("assumed", note=note)
        self._log.info("source", name=self._source.name, frames=self._source.frame_count, first=host.sequence + 1)
        if not position.ended:
            if self._live:
                self._wait_for_services(host)  # what it saw while the others were starting is not news
            with Prefetch(self._source, host.sequence + 1, partial(self.metrics.observe_ms, "read")) as ahead:
                try:
                    self._wait_for_services(host)
                    delivery = configured_delivery(self._config, host.sequence + 1, self._position_file, self._outlet)
                    self._deliver(ahead, delivery, host)
                finally:
                    if self._live:
                        # Its next frame may never come, and nobody leaves while one is read.
                        self._source.close()
                if ahead.failure is not None:
                    raise ahead.failure
                if not delivery.ended:
                    return
        host.state = "done"

    def _wait_for_services(self, host: Host) -> None:
        said_s = time.monotonic()
        while (missing := self._presence.wait_for_all(_TICK_S)) and not host.stopping.is_set():
            if time.monotonic() - said_s >= _SAY_WHO_IS_MISSING_S:
                said_s = time.monotonic()
                self._log.warning("waiting_for_services", missing=",".join(missing))
        self._presence.take_came()

    def _deliver(self, ahead: Prefetch, delivery: Delivery, host: Host) -> None:
        while not (delivery.ended or host.stopping.is_set()):
            if self._presence.take_came():
                delivery.service_came(time.monotonic())
            if delivery.wants_frame and (not self._live or ahead.has_next(_TICK_S)):
                delivery.offer(ahead.next(), time.monotonic())
            sent_again = delivery.sent_again
            wait_s = delivery.step(time.monotonic())
            if delivery.sent_again > sent_again:
                self.metrics.count("sent_again", delivery.sent_again - sent_again)
                self._log.warning_limited("sent_again", waiting_for=delivery.waiting_for())
            message = self._answers.receive(min(wait_s, _TICK_S))
            while message is not None:
                if message.envelope.session == self._config.run.session:
                    delivery.answered(message.suffix, message.envelope.sequence)
                message = self._answers.receive(0.0)
            host.sequence = delivery.done


def serve(config: Config) -> None:
    """Publish the frames of an input: a dataset's folder, a video, a recorded session or the simulator."""
    source = open_configured_source(config)
    try:
        with ZenohBus(config.bus, lossless=config.delivery.mode == "lossless") as bus:
            camera = CameraService(source, bus, config)
            with ServiceHost(NAME, bus, config.run.session) as host:
                host.metrics = camera.metrics.values
                host.ready()
                camera.run(host)
                host.stopping.wait()
    finally:
        source.close()


if __name__ == "__main__":
    run_main(NAME, serve)
