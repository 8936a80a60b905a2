# SPDX-License-Identifier: Apache-2.0
"""What every service process does: signals, heartbeat, liveliness, one clear line for what cannot be."""

import argparse
import ctypes
import os
import resource
import signal
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Protocol, Self

from schemas import topics
from schemas.codec import encode
from schemas.records import Heartbeat
from services.runtime.bus import Bus
from services.runtime.config import Config, load_config
from services.runtime.envelope import Envelope
from services.runtime.errors import KinemapError
from services.runtime.log import get_logger, set_up_logging
from services.runtime.outbox import Outbox
from services.runtime.service import FrameService
from services.runtime.service_loop import FrameLoop
from services.runtime.zenoh_bus import ZenohBus

HEARTBEAT_S = 1.0
_PR_SET_PDEATHSIG = 1


def die_with_parent() -> None:
    """Have the kernel send SIGTERM when the supervisor dies, however it dies (Linux)."""
    ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)


class Steps(Protocol):
    """What a host drives."""

    @property
    def sequence(self) -> int:
        """The last frame done, -1 for none yet."""

    @property
    def ended(self) -> bool:
        """Whether the end of the input is done."""

    def step(self, timeout_s: float) -> bool:
        """Handle one message if one comes within `timeout_s`; false when none did."""


class ServiceHost:
    """A service's presence on the bus: a heartbeat once a second, and liveliness from `ready` on."""

    def __init__(self, name: str, bus: Bus, session: str) -> None:
        self.name = name
        self.stopping = self.catch_signals()
        self.state = "starting"
        self.sequence = -1
        self.metrics: Callable[[], dict[str, float]] = dict
        self._bus = bus
        self._session = session
        self._beats = 0
        self._over = threading.Event()
        self._beating = threading.Thread(target=self._beat, name="heartbeat", daemon=True)
        self._beating.start()

    @staticmethod
    def catch_signals() -> threading.Event:
        """An event that SIGTERM and SIGINT set."""
        event = threading.Event()
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, lambda *_: event.set())
        return event

    def ready(self) -> None:
        """Subscriptions stand: tell the others."""
        self.state = "running"
        self._bus.declare_alive(self.name)
        self.send_heartbeat()

    def drive(self, loop: Steps) -> None:
        """Step `loop` until SIGTERM; then do what has already arrived, and return."""
        self.sequence = loop.sequence
        self.ready()
        while not self.stopping.is_set():
            loop.step(0.1)
            self.sequence = loop.sequence
            self.state = "done" if loop.ended else "running"
        self.state = "draining"
        while loop.step(0.0):
            self.sequence = loop.sequence
        self.state = "done" if loop.ended else "stopped"

    def send_heartbeat(self) -> None:
        """One heartbeat now."""
        record = Heartbeat(
            self.name,
            os.getpid(),
            self.state,
            self.sequence,
            resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
            self.metrics(),
        )
        envelope = Envelope(self._session, self._beats, 0)
        self._beats += 1
        self._bus.publish(topics.HEARTBEAT, encode(topics.HEARTBEAT, record), envelope, self.name)

    def _beat(self) -> None:
        while not self._over.wait(HEARTBEAT_S):
            self.send_heartbeat()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self._over.set()
        self._beating.join()
        self.send_heartbeat()


def run_frame_service(service: FrameService, bus: Bus, config: Config) -> None:
    """Run `service` on `bus` until SIGTERM."""
    folder = config.run.out / "state" / service.name
    lossless = config.delivery.mode == "lossless"
    service.keep_state_in(folder)
    outbox = Outbox(2 * config.delivery.window, folder if lossless and service.snapshot() is not None else None)
    try:
        loop = FrameLoop(service, bus, config.delivery, config.run.session, outbox)
        with ServiceHost(service.name, bus, config.run.session) as host:
            host.metrics = lambda: {**loop.metrics.values(), **service.metrics(), **_drops(loop)}
            host.drive(loop)
    finally:
        service.close()


def _drops(loop: FrameLoop) -> dict[str, float]:
    return {f"dropped {key}": float(count) for key, count in loop.drop_counts().items()}


def run_main(name: str, serve: Callable[[Config], None]) -> None:
    """The main() of every service process: `--config FILE`, logs, one exception root."""
    parser = argparse.ArgumentParser(prog=f"kinemap {name}", description=serve.__doc__)
    parser.add_argument("--config", type=Path, help="TOML file of the run (see kinemap config dump)")
    arguments = parser.parse_args()
    log = get_logger(name)
    try:
        die_with_parent()
        config = load_config(arguments.config)
        set_up_logging(config.log)
        serve(config)
    except KinemapError as error:
        log.error("stopped", error=error)
        _say_why(arguments.config, name, error)
        sys.exit(error.exit_code)


def _say_why(config_file: Path | None, name: str, error: KinemapError) -> None:
    """Leave the one line where whoever started the services looks for it."""
    print(f"kinemap {name}: error: {error}", file=sys.stderr)
    if config_file is not None:
        (config_file.parent / f"{name}.error").write_text(f"{error}\n", encoding="utf-8")


def run_service(factory: Callable[[Config], FrameService], name: str) -> None:
    """The whole main() of a service that works frame by frame."""

    def serve(config: Config) -> None:
        service = factory(config)
        try:
            bus = ZenohBus(config.bus, lossless=config.delivery.mode == "lossless")
        except KinemapError:
            service.close()
            raise
        with bus:
            run_frame_service(service, bus, config)

    run_main(name, serve)
