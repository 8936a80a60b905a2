# SPDX-License-Identifier: Apache-2.0
"""`kinemap record`: an input, or what is on the bus now, into one MCAP file."""

import json
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from schemas import topics
from schemas.codec import encode
from schemas.records import EndOfInput
from services.camera.prefetch import Prefetch
from services.camera.sources.live.live_address import is_live, without_credentials
from services.camera.sources.source import Source
from services.cli.flags import ConfigFlag, InputArgument, Overrides, SetFlag, resolve_config
from services.cli.pipeline_run import InterruptedRunError
from services.recorder.recorded_key import key_of
from services.recorder.session_writer import SessionWriter, WriterOptions
from services.runtime.bus import Subscription
from services.runtime.config import Config, dump_config
from services.runtime.errors import InputError
from services.runtime.log import get_logger, set_up_logging
from services.runtime.session_file import RecordedMessage
from services.runtime.zenoh_bus import ZenohBus

_CHUNK_BYTES = 4 << 20
_CHUNK_S = 1.0
_LISTEN_S = 0.1
# slam and mapstore have a last word under the end's sequence number.
_AFTER_END_S = 1.0

Messages = Iterator[tuple[str, RecordedMessage] | None]
"""The session and one message of it; None: nothing new at this moment"""


def record(
    given_input: InputArgument = None,
    file: Annotated[
        Path, typer.Option("--file", "-f", help="The recording; an existing file is never overwritten.")
    ] = (Path("session.mcap")),
    bus: Annotated[
        bool,
        typer.Option("--bus", help="Record what is on the bus (bus.entry_point), until the input's end or Ctrl-C."),
    ] = False,
    config: ConfigFlag = None,
    settings: SetFlag = None,
) -> None:
    """Record INPUT's camera topics as fast as they can be read, or with --bus every topic that is on the bus."""
    if bus and given_input is not None:
        raise InputError(f"{given_input}: expected either an input or --bus, not both")
    flags: Overrides = {"camera": {"input": given_input}}
    resolved = resolve_config(config, settings, flags)
    if file.exists():
        raise InputError(f"--file {file}: exists, expected the name of a new file")
    set_up_logging(resolved.log)
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    if bus:
        with ZenohBus(resolved.bus, lossless=False) as entered:
            subscription = entered.subscribe(topic for topic in topics.TOPICS if topic.recorded)
            where = resolved.bus.router or resolved.bus.entry_point
            Console(markup=False).print(
                f"listening on {where} until the input's end or Ctrl-C", highlight=False, soft_wrap=True
            )
            count = _write(file, resolved, messages_of_bus(subscription, resolved, stop))
        if not count:
            raise InputError(f"--file {file}: nothing to record was heard; is `kinemap up` running on this bus?")
    else:
        if is_live(resolved.camera.input):
            what = without_credentials(resolved.camera.input)
            Console(markup=False).print(f"recording {what} until Ctrl-C", highlight=False, soft_wrap=True)
        count = _write(file, resolved, messages_of_input(resolved, stop))
        if not count:
            raise InterruptedRunError("stopped by the user before the first frame: nothing was recorded")
    Console(markup=False).print(f"{file}: {count} messages", highlight=False, soft_wrap=True)


def messages_of_input(config: Config, stop: threading.Event) -> Messages:
    """What the camera service would publish of the configured input, then the end of input; until `stop` at the latest.

    Raises InputError, after the end of what went before, for a frame that cannot be used.
    """
    from services.camera.configured_source import open_configured_source

    source = open_configured_source(config)
    for note in source.notes:
        get_logger("camera").warning("assumed", note=note)
    try:
        with Prefetch(source, 0, lambda _: None) as ahead:
            try:
                yield from _messages_of(source, ahead, config.run.session, stop)
            finally:
                if is_live(config.camera.input):
                    # Its next frame may never come, and nobody leaves while one is read.
                    source.close()
            if ahead.failure is not None:
                raise ahead.failure
    finally:
        source.close()


def _messages_of(source: Source, ahead: Prefetch, session: str, stop: threading.Event) -> Messages:
    from services.camera.frame_records import frame_records

    sequence, timestamp_ns = 0, -1
    while not stop.is_set():
        if not ahead.has_next(_LISTEN_S):
            yield None
            continue
        frame = ahead.next()
        if frame is None:
            break
        timestamp_ns = frame.timestamp_ns
        for topic, frame_record in frame_records(frame, source):
            yield session, RecordedMessage(topic.key, sequence, timestamp_ns, encode(topic, frame_record))
        sequence += 1
    if sequence:
        end = EndOfInput(timestamp_ns + 1, sequence)
        yield session, RecordedMessage(topics.END.key, sequence, end.timestamp_ns, encode(topics.END, end))


def messages_of_bus(subscription: Subscription, config: Config, stop: threading.Event) -> Messages:
    """Everything of one session until its end: the first session heard, or the configured one where one is named."""
    session = config.run.session if "session" in config.run.model_fields_set else None
    ended = False
    while not stop.is_set():
        message = subscription.receive(_AFTER_END_S if ended else _LISTEN_S)
        if message is None:
            if ended:
                return
            yield None
            continue
        session = session or message.envelope.session
        if message.envelope.session == session:
            ended = ended or message.topic is topics.END
            _, sequence, timestamp_ns = message.envelope
            key = key_of(message.topic, message.suffix)
            yield session, RecordedMessage(key, sequence, timestamp_ns, message.payload)


def _write(file: Path, config: Config, messages: Messages) -> int:
    """Write chunk by chunk; what was written stays readable whatever ends it, and is whole when the input is bad."""
    options = WriterOptions(config.recorder.zstd_level, config.recorder.reserve_mb << 20)
    config_json = json.dumps(dump_config(config), sort_keys=True)
    writer: SessionWriter | None = None
    failure: InputError | None = None
    chunk: list[RecordedMessage] = []
    size, count, begun_s = 0, 0, time.monotonic()
    try:
        try:
            for message in messages:
                if message is not None:
                    session, recorded = message
                    writer = writer or SessionWriter(file, session, config_json, options)
                    chunk.append(recorded)
                    size += len(recorded.payload)
                    count += 1
                now_s = time.monotonic()
                if writer is not None and chunk and (size >= _CHUNK_BYTES or now_s - begun_s >= _CHUNK_S):
                    writer.append(chunk)
                    chunk, size, begun_s = [], 0, now_s
        except InputError as error:
            failure = error
        if writer is not None:
            writer.append(chunk)
            writer.finish()
    finally:
        if writer is not None:
            writer.close()
    if failure is not None:
        raise failure
    return count
