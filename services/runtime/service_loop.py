# SPDX-License-Identifier: Apache-2.0
"""The loop of a service that works frame by frame: join, keep order, process once, remember, send, answer."""

import time

from schemas import topics
from schemas.codec import decode, encode
from schemas.records import FrameAnswer
from schemas.topics import Topic
from services.runtime.bus import Bus, Message
from services.runtime.config.delivery import DeliveryConfig
from services.runtime.errors import ProtocolError
from services.runtime.log import get_logger
from services.runtime.metrics import Metrics
from services.runtime.outbox import Outbox, Sent
from services.runtime.service import Bundle, FrameService
from services.runtime.synchronizer import RawBundle, Synchronizer


def _least(pending_bundles: int, service: FrameService) -> int:
    return pending_bundles if service.most_pending is None else min(pending_bundles, service.most_pending)


class FrameLoop:
    """Drives one FrameService from one bus.

    `lossless`: a service with state sees every frame once and in sequence, whatever is repeated or comes early; a
    repeated frame is answered from the outbox. `realtime`: the newest complete frame wins.
    """

    def __init__(self, service: FrameService, bus: Bus, delivery: DeliveryConfig, session: str, outbox: Outbox) -> None:
        self._service = service
        self._bus = bus
        self._session = session
        self._outbox = outbox
        self._lossless = delivery.mode == "lossless"
        self._ahead_limit = 4 * delivery.window
        self._ahead: dict[int, Bundle] = {}
        self._log = get_logger(service.name)
        self.metrics = Metrics()
        self.ended = False
        self.sequence = self._resume()
        deadline_ns = None if self._lossless else int(delivery.deadline_s * 1e9)
        self._synchronizer = Synchronizer(
            service.awaits,
            final_awaits=service.final_awaits,
            deferrable=service.deferrable,
            capacity=delivery.pending_bundles if self._lossless else _least(delivery.pending_bundles, service),
            newest_wins=not self._lossless,
            deadline_ns=deadline_ns,
        )
        wanted = dict.fromkeys((topics.MANIFEST, *service.awaits, *service.final_awaits, topics.END))
        self._subscription = bus.subscribe(wanted, keep_all=self._lossless)

    def _resume(self) -> int:
        """The last frame done before this process began, -1 for none."""
        own = self._service.last_sequence()
        restored = self._outbox.restore(self._session)
        if restored is None:
            self._stateful = self._service.snapshot() is not None or own is not None
            return -1 if own is None else own
        sequence, state = restored
        self._service.restore(state)
        self._stateful = True
        self._log.info("resumed", sequence=sequence)
        return sequence

    def step(self, timeout_s: float) -> bool:
        """Handle one message if one comes within `timeout_s`; false when none did."""
        message = self._subscription.receive(timeout_s)
        if message is not None:
            self._take(message)
        if not self._lossless:
            for raw in self._synchronizer.due(time.monotonic_ns()):
                self._dispatch(raw)
        for dropped in self._synchronizer.take_dropped():
            self.metrics.count("frames_dropped")
            self._log.warning_limited(
                "frame_dropped",
                sequence=dropped.envelope.sequence,
                reason=dropped.reason,
                missing=",".join(dropped.missing),
            )
        return message is not None

    def _take(self, message: Message) -> None:
        if message.envelope.session != self._session:
            self.metrics.count("other_session")
            return
        try:
            raw = self._synchronizer.add(message, time.monotonic_ns())
            if raw is not None:
                self._dispatch(raw)
        except ProtocolError as error:
            self.metrics.count("messages_unreadable")
            self._log.warning_limited("message_unreadable", error=error)

    def _dispatch(self, raw: RawBundle) -> None:
        sequence = raw.envelope.sequence
        done = self._outbox.get(sequence) is not None or (self._stateful and sequence <= self.sequence)
        if done and self._lossless:
            self._repeat(raw)
            return
        records = {topic: decode(topic, message.payload) for topic, message in raw.messages.items()}
        bundle = Bundle(raw.envelope, records, raw.missing)
        if not (self._lossless and self._stateful):
            self._process(bundle)
            return
        if len(self._ahead) >= self._ahead_limit:
            self._ahead.pop(max(self._ahead))
        self._ahead[sequence] = bundle
        while (following := self._ahead.pop(self.sequence + 1, None)) is not None:
            self._process(following)

    def _repeat(self, raw: RawBundle) -> None:
        self.metrics.count("frames_repeated")
        sent = self._outbox.get(raw.envelope.sequence)
        if sent is not None:
            self._send(sent)
        elif self._service.answers:
            self._answer(Sent(raw.envelope, ()))

    def _process(self, bundle: Bundle) -> None:
        held = self._synchronizer.pending_times_ns() | self._subscription.frame_times_ns()
        self.metrics.at_most("frames_held", len(held | {bundle.timestamp_ns}))
        started = time.perf_counter()
        ending = bundle.get(topics.END) is not None
        outgoing = self._service.finish(bundle) if ending else self._service.process(bundle)
        messages: tuple[tuple[Topic, bytes], ...] = tuple(
            (out.topic, encode(out.topic, out.record)) for out in outgoing
        )
        sent = Sent(bundle.envelope, messages)
        state = self._service.snapshot() if self._lossless else None
        if state is not None and not self._stateful:
            raise TypeError(
                f"{self._service.name}: snapshot() was None at the start, expected arrays, if only empty ones"
            )
        self._outbox.record(sent, state)
        self.sequence = max(self.sequence, bundle.envelope.sequence)
        if not ending:
            self.metrics.observe_ms("process", (time.perf_counter() - started) * 1e3)
            self.metrics.count("frames")
        self._send(sent)
        self.ended = self.ended or ending

    def _send(self, sent: Sent) -> None:
        for topic, payload in sent.messages:
            self._bus.publish(topic, payload, sent.envelope)
        if self._service.answers:
            self._answer(sent)

    def _answer(self, sent: Sent) -> None:
        answer = FrameAnswer(sent.envelope.timestamp_ns, self._service.name)
        self._bus.publish(topics.ANSWER, encode(topics.ANSWER, answer), sent.envelope, self._service.name)

    def drop_counts(self) -> dict[str, int]:
        """Messages that full queues have dropped."""
        return self._subscription.drop_counts()
