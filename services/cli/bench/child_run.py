# SPDX-License-Identifier: Apache-2.0
"""One `kinemap run` as a child process: the real pipeline, on the code path that a user takes."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple, Protocol

import tomli_w

from services.cli.bench.plan import PlannedRun
from services.runtime.errors import ResourceError

_ERROR = "kinemap: error: "
_FRAMES = re.compile(rb"^(\d+)/(\d+) frames", re.MULTILINE)
_TAIL_BYTES = 4096
_STOP_PATIENCE_S = 30.0
# After the last frame the map is still exported and the report made.
_UNTIL_THE_RESULTS = 0.95


class RunEnd(NamedTuple):
    """How a run ended: its one line where it failed, else nothing."""

    failure: str
    wall_s: float


class RunningRun(Protocol):
    """A run that goes on."""

    def wait(self, timeout_s: float) -> RunEnd | None:
        """How it ended; None where it has not after `timeout_s`."""

    def share_done(self) -> float:
        """How much of its input it has done, 0..1, as far as it tells."""

    def stop(self) -> None:
        """End it politely, and wait until it has; it keeps what it has."""


class Runner(Protocol):
    """Starts runs in a benchmark's folder."""

    def start(self, run: PlannedRun, folder: Path) -> RunningRun:
        """Begin `run` in `folder`, which does not exist."""


class ProcessRunner:
    """Starts runs as processes."""

    def start(self, run: PlannedRun, folder: Path) -> RunningRun:
        """Write the configuration beside `folder` and begin. Raises ResourceError where that cannot be written."""
        config = folder.with_name(f"{folder.name}.toml")
        try:
            folder.parent.mkdir(parents=True, exist_ok=True)
            config.write_text(tomli_w.dumps(run.configuration), encoding="utf-8")
        except OSError as error:
            raise ResourceError(f"{config} cannot be written: {error.strerror}") from error
        return ChildRun(config, folder)


class ChildRun:
    """`kinemap run --config CONFIG --out FOLDER`; what it prints is kept beside the folder."""

    def __init__(self, config: Path, folder: Path) -> None:
        self._log = folder.with_name(f"{folder.name}.log")
        # The configuration is resolved: the environment had its say in it, and must not override a variant.
        environment = {name: value for name, value in os.environ.items() if not name.startswith("KINEMAP_")}
        command = [sys.executable, "-m", "services.cli.bench.child", str(os.getpid()), "run"]
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(
                [*command, "--config", str(config), "--out", str(folder)],
                stdout=log,
                stderr=subprocess.STDOUT,
                stdin=subprocess.DEVNULL,
                env={**environment, "NO_COLOR": "1"},
                # Ctrl-C in the terminal is for the benchmark alone, which then stops its runs.
                start_new_session=True,
            )
        self._began_s = time.monotonic()

    def wait(self, timeout_s: float) -> RunEnd | None:
        """How it ended; None where it has not after `timeout_s`."""
        try:
            code = self._process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            return None
        return RunEnd(self._failure(code), time.monotonic() - self._began_s)

    def share_done(self) -> float:
        """How much of its input it has done, by the last line of progress that it printed."""
        with self._log.open("rb") as log:
            log.seek(max(0, self._log.stat().st_size - _TAIL_BYTES))
            found = _FRAMES.findall(log.read())
        if not found or int(found[-1][1]) == 0:
            return 0.0
        return min(int(found[-1][0]) / int(found[-1][1]), _UNTIL_THE_RESULTS)

    def stop(self) -> None:
        """Interrupt it as Ctrl-C would; it writes what it has, and is killed where it does not end."""
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(_STOP_PATIENCE_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _failure(self, code: int) -> str:
        if code == 0:
            return ""
        lines = [line for line in self._log.read_text(encoding="utf-8", errors="replace").splitlines() if line.strip()]
        errors = [line.removeprefix(_ERROR) for line in lines if line.startswith(_ERROR)]
        return errors[-1] if errors else f"exit code {code}; see {self._log}"
