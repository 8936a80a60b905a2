# SPDX-License-Identifier: Apache-2.0
"""The services of one run as processes under supervisord: start, watch, stop."""

import os
import re
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from services.cli.leftovers import end, processes_of
from services.cli.readiness import Readiness
from services.cli.supervisord_client import ProcessInfo, SupervisordClient, socket_of
from services.cli.supervisord_config import run_environment, supervisord_config
from services.runtime.config import Config
from services.runtime.errors import InputError, KinemapError
from services.runtime.process_table import PROCESSES, ServiceProcess
from services.runtime.zenoh_bus import ZenohBus

READY_WITHIN_S = 60.0
STOP_PATIENCE_S = 5.0
_SPAWNED = re.compile(r" INFO spawned: '([^']+)' with pid \d+$", re.MULTILINE)


class ServiceFailedError(KinemapError):
    """A service has given up for good; the exit code is its own."""

    def __init__(self, message: str, exit_code: int = 1) -> None:
        super().__init__(message)
        self.exit_code = exit_code


@dataclass(frozen=True)
class ServiceStatus:
    """One service of a run, for people."""

    name: str
    state: str
    """down (there is no supervisord), starting, running, backoff, stopping, stopped, exited or fatal"""
    pid: int | None
    uptime_s: int
    restarts: int
    problem: str
    """the one line that it ended with; empty where it is well"""
    log: Path


class Supervision:
    """Starts, watches and stops the services of the run in `run_folder`, whose config.toml is written already.

    `attached`: supervisord, and with it all services, ends when this process does, however that ends. Otherwise they
    go on in the background; another Supervision of the same folder finds them.
    """

    def __init__(
        self,
        run_folder: Path,
        config: Config,
        *,
        attached: bool = False,
        processes: tuple[ServiceProcess, ...] = PROCESSES,
    ) -> None:
        self.folder = run_folder.resolve()
        self.logs = self.folder / "logs"
        self._config = config
        self._attached = attached
        self._processes = processes
        self._config_file = self.folder / "config.toml"
        self._supervisord_file = self.folder / "supervisord.conf"
        self._socket = socket_of(self.folder)
        self._client = SupervisordClient(self._socket)
        self._process: subprocess.Popen[bytes] | None = None

    def up(self, ready_within_s: float = READY_WITHIN_S) -> None:
        """Start all services and return when each has told on the bus that it lives. What failed is stopped again.

        Raises:
            InputError: the services of this run are up already.
            ServiceFailedError: a service gave up, with its line and exit code.
            NotReadyError: services are not ready in time, with their names.
        """
        if self._client.pid() is not None:
            raise InputError(f"{self.folder}: its services are up already; `kinemap down {self.folder}` stops them")
        self._end_leftovers()
        try:
            with ZenohBus(self._config.bus, lossless=False) as bus:
                readiness = Readiness([process.name for process in self._processes if process.has_liveliness])
                bus.watch_alive(readiness.on_change)
                self._start_supervisord()
                readiness.wait(ready_within_s, self.failure)
        except BaseException:
            self.down()
            raise

    def down(self) -> None:
        """Let all services finish what has arrived, and stop them; again does no harm."""
        own = self._process
        if self._client.stop_all():
            patience_s = STOP_PATIENCE_S + max(process.stop_wait_s for process in self._processes)
            if own is not None:
                _wait(own, patience_s)
            else:
                _wait_for_end(lambda: self._client.pid() is None, patience_s)
        self._end_leftovers()
        if own is not None:
            _wait(own, STOP_PATIENCE_S)
        for file in (self._socket, self.folder / "supervisord.pid"):
            file.unlink(missing_ok=True)
        if self._socket.parent != self.folder and self._socket.parent.is_dir():
            self._socket.parent.rmdir()

    def status(self) -> list[ServiceStatus]:
        """Every service, in the order of the table."""
        infos = {info.name: info for info in self._client.processes() or []}
        spawns = self._spawns()
        return [self._status_of(name, infos.get(name), spawns[name]) for name in (row.name for row in self._processes)]

    def _status_of(self, name: str, info: ProcessInfo | None, spawns: int) -> ServiceStatus:
        log, restarts = self.logs / f"{name}.log", max(0, spawns - 1)
        if info is None:
            return ServiceStatus(name, "down", None, 0, restarts, self._error_of(name), log)
        problem = "" if info.state in {"starting", "running"} or info.ended_well else self._last_words(name)
        return ServiceStatus(name, info.state, info.pid or None, info.uptime_s, restarts, problem, log)

    def failure(self) -> KinemapError | None:
        """The error of a service that has given up for good, else None. A service that is being restarted has not."""
        processes = self._client.processes()
        if processes is None:
            return ServiceFailedError(f"supervisord of {self.folder} is gone; see {self.logs / 'supervisord.log'}")
        for info in processes:
            gave_up = info.state == "exited" and info.exit_code == InputError.exit_code
            if gave_up or info.state == "fatal":
                code = InputError.exit_code if gave_up else ServiceFailedError.exit_code
                return ServiceFailedError(f"{info.name}: {self._last_words(info.name)}", code)
        return None

    def _start_supervisord(self) -> None:
        self.logs.mkdir(parents=True, exist_ok=True)
        self._socket.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        stale_files = (*self.folder.glob("*.error"), *self.logs.glob("*.starts"), self.logs / "supervisord.log")
        for stale in stale_files:
            stale.unlink(missing_ok=True)
        self._supervisord_file.write_text(supervisord_config(self._processes), encoding="utf-8")
        # The run's file is the whole truth: KINEMAP_<SECTION>__<FIELD> went into it and must not override it again.
        inherited = {name: value for name, value in os.environ.items() if not name.startswith("KINEMAP_")}
        variables = run_environment(self._config_file, self.folder, self._socket)
        parent = [str(os.getpid())] if self._attached else []
        with (self.logs / "supervisord.out").open("wb") as out:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "services.cli.supervisord_process", str(self._supervisord_file), *parent],
                env={**inherited, **variables},
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        answered = _wait_for_end(lambda: self._client.pid() is not None or self._process_ended(), READY_WITHIN_S)
        if not answered or self._process_ended():
            said = (self.logs / "supervisord.out").read_text(encoding="utf-8", errors="replace").splitlines()
            why = next((line for line in said if line.startswith("Error")), said[-1] if said else "no reason given")
            raise ServiceFailedError(f"supervisord does not start: {why}")

    def _end_leftovers(self) -> None:
        modules = [process.module for process in self._processes]
        end(processes_of(modules, self._config_file, self._supervisord_file), STOP_PATIENCE_S)

    def _process_ended(self) -> bool:
        return self._process is not None and self._process.poll() is not None

    def _spawns(self) -> Counter[str]:
        """How often each service was spawned, by supervisord's log of this run."""
        log = self.logs / "supervisord.log"
        return Counter(_SPAWNED.findall(log.read_text(encoding="utf-8", errors="replace")) if log.exists() else ())

    def _error_of(self, name: str) -> str:
        """The line that a service left when it gave up; empty where it left none."""
        file = self.folder / f"{name}.error"
        return file.read_text(encoding="utf-8", errors="replace").strip() if file.exists() else ""

    def _last_words(self, name: str) -> str:
        """The line that a service left when it gave up, else the last one of its log."""
        log = self.logs / f"{name}.log"
        lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines() if log.exists() else []
        return self._error_of(name) or (lines[-1] if lines else f"nothing said; see {log}")


def _wait(process: subprocess.Popen[bytes], within_s: float) -> None:
    try:
        process.wait(within_s)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _wait_for_end(ended: Callable[[], bool], within_s: float) -> bool:
    give_up_s = time.monotonic() + within_s
    waiting = threading.Event()
    while not (is_over := ended()) and time.monotonic() < give_up_s:
        waiting.wait(0.05)
    return is_over
