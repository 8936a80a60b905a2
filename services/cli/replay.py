# SPDX-License-Identifier: Apache-2.0
"""`kinemap replay`: a recorded session back onto the bus, or its camera through the pipeline again."""

import contextlib
import math
import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from services.cli.flags import ConfigFlag, OutFlag, Overrides, PortFlag, SetFlag, StageFlag, resolve_config
from services.cli.ports import is_free
from services.cli.run import resolve_run, run_input
from services.recorder.replay_pace import AsAnswered, Pace, RecordedRate
from services.recorder.replayer import Replayer
from services.runtime.bus import Bus
from services.runtime.config.bus import BusConfig
from services.runtime.errors import InputError
from services.runtime.session_file import SessionFile
from services.runtime.zenoh_bus import ZenohBus, open_session

# Whoever is on the bus looks for its entry point every half a second.
_LISTENERS_S = 1.0
_SERVICE_PATIENCE_S = 15.0


def replay(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Recorded session (.mcap).")],
    *,
    camera: Annotated[
        bool, typer.Option("--camera", help="Its camera alone: all other services run again, as in `kinemap run`.")
    ] = False,
    speed: Annotated[float, typer.Option(help="Times the recorded rate.")] = 1.0,
    topic: Annotated[list[str] | None, typer.Option(help="Only this topic, such as slam/pose; repeatable.")] = None,
    wait_for: Annotated[
        list[str] | None,
        typer.Option("--wait-for", metavar="SERVICE", help="As fast as this service answers; repeatable."),
    ] = None,
    recover: Annotated[bool, typer.Option("--recover", help="Read what is whole of a file that was cut off.")] = False,
    stage: StageFlag = None,
    out: OutFlag = None,
    port: PortFlag = None,
    serve: Annotated[bool, typer.Option("--serve", help="With --camera: keep everything up afterwards.")] = False,
    config: ConfigFlag = None,
    settings: SetFlag = None,
) -> None:
    """Feed a recorded session to whoever listens: all of it as it was, or (--camera) its camera to a new run."""
    if camera:
        flags: Overrides = {
            "camera": {"input": str(file)},
            "slam": {"stage": stage},
            "mapstore": {"http_port": port},
        }
        run_input(resolve_run(config, settings, flags, out), serve)
        return
    if not (math.isfinite(speed) and speed > 0.0):
        raise InputError(f"--speed {speed}: expected a number above 0")
    bus_config = resolve_config(config, settings, {}).bus
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    with SessionFile(file, recover=recover) as session, _entered_bus(bus_config) as bus:
        keys = _known(topic, session)
        pace: Pace = RecordedRate(speed, stop)
        if wait_for:
            pace = AsAnswered(bus, session.session, wait_for, stop=stop)
        _let_listeners_in(bus, wait_for or [], stop)
        count = Replayer(session, bus).play(pace, keys)
        ended = "stopped" if stop.is_set() else "done"
        Console(markup=False).print(
            f"{ended}: {count} messages of session {session.session}", highlight=False, soft_wrap=True
        )


def _let_listeners_in(bus: Bus, services: list[str], stop: threading.Event) -> None:
    """Wait until `services` live; others who listen already have a second to find this end of the bus."""
    missing, all_there = set(services), threading.Event()

    def changed(name: str, alive: bool) -> None:
        if alive:
            missing.discard(name)
        if not missing:
            all_there.set()

    bus.watch_alive(changed)
    if services:
        patience_s = _SERVICE_PATIENCE_S
        while patience_s > 0 and not all_there.wait(_LISTENERS_S) and not stop.is_set():
            patience_s -= _LISTENERS_S
        if missing and not stop.is_set():
            raise InputError(
                f"--wait-for {', '.join(sorted(missing))}: does not live on this bus; is `kinemap up` running?"
            )
    stop.wait(_LISTENERS_S)


def _known(topics: list[str] | None, session: SessionFile) -> list[str] | None:
    counts = session.message_counts()
    for key in topics or []:
        if key not in counts:
            raise InputError(f"--topic {key}: not in {session.path}, expected one of {', '.join(counts)}")
    return topics


@contextlib.contextmanager
def _entered_bus(config: BusConfig) -> Iterator[Bus]:
    """The bus of the configuration; where nobody holds its entry point yet, this process does, for others to join."""
    scheme, _, address = config.entry_point.partition("/")
    host, _, port = address.rpartition(":")
    with contextlib.ExitStack() as stack:
        if config.router is None and scheme == "tcp" and port.isdigit() and is_free(host.strip("[]"), int(port)):
            session = open_session(config, listen=config.entry_point, connect=False)
            stack.callback(session.close)
        yield stack.enter_context(ZenohBus(config, lossless=True))
