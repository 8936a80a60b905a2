# SPDX-License-Identifier: Apache-2.0
"""How soon each service is back after kill -9 in the middle of a run, into docs/measurements.md.

    python -m tests.benchmark.pipeline.restart [INPUT] [--frames 200]

A service is back when it says on the bus that it is ready; the bus's entry point when its process is there again.
"""

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
from pathlib import Path

import psutil

from services.runtime.config import load_config
from services.runtime.process_table import PROCESSES
from services.runtime.zenoh_bus import ZenohBus
from tests.benchmark.measurements_page import markdown_table, put

HEADER = ("killed", "new process after", "ready after")
LIMIT_S = 60.0


class Presence:
    """When each service came last, by liveliness."""

    def __init__(self) -> None:
        self._came: dict[str, float] = {}
        self._changed = threading.Condition()

    def changed(self, name: str, alive: bool) -> None:
        """A service came or went."""
        with self._changed:
            if alive:
                self._came[name] = time.monotonic()
            self._changed.notify_all()

    def wait(self, name: str, since_s: float) -> float:
        """Seconds from `since_s` until it came."""
        with self._changed:
            if not self._changed.wait_for(lambda: self._came.get(name, -1.0) > since_s, LIMIT_S):
                raise SystemExit(f"{name} did not come back within {LIMIT_S} s")
            return self._came[name] - since_s


def pid_of(module: str, folder: Path) -> int | None:
    """The process that runs `module` for the run in `folder`."""
    for process in psutil.process_iter(["cmdline"]):
        line = " ".join(process.info["cmdline"] or [])
        if f"-m {module} " in line and str(folder) in line:
            return int(process.pid)
    return None


def kill_and_wait(name: str, module: str, folder: Path, presence: Presence) -> list[str]:
    """One row of the table."""
    before = pid_of(module, folder)
    if before is None:
        raise SystemExit(f"{name} is not running")
    os.kill(before, signal.SIGKILL)
    killed_s = time.monotonic()
    while pid_of(module, folder) in (None, before):
        time.sleep(0.02)
    new_process = f"{time.monotonic() - killed_s:.2f} s"
    return [name, new_process, f"{presence.wait(name, killed_s):.2f} s" if name != "bus" else "-"]


def main() -> None:
    """Run, kill one after the other, see the run through, then write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", nargs="?", default="simulator")
    parser.add_argument("--frames", type=int, default=200)
    arguments = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        command = [sys.executable, "-m", "services.cli.app", "run", arguments.source, "--out", str(out), "--port", "0"]
        with subprocess.Popen([*command, "--frames", str(arguments.frames)]) as run:
            while not (out / "config.toml").exists() or not tomllib.loads((out / "config.toml").read_text()):
                time.sleep(0.05)
            presence = Presence()
            with ZenohBus(load_config(out / "config.toml").bus, lossless=False) as bus:
                bus.watch_alive(presence.changed)
                presence.wait("camera", 0.0)
                for process in PROCESSES:
                    if process.name != "slam":
                        time.sleep(1.0)  # let the run go on between two kills
                        rows.append(kill_and_wait(process.name, process.module, out, presence))
                code = run.wait()
        report = json.loads((out / "report.json").read_text(encoding="utf-8"))
        frames = report["frames"]
        rows.append([f"exit code {code}", f"{frames['answered']} of {frames['in']} frames accounted for", ""])
    put("restart", "python -m tests.benchmark.pipeline.restart", markdown_table(HEADER, rows))


if __name__ == "__main__":
    main()
