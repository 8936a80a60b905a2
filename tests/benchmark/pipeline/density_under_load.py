# SPDX-License-Identifier: Apache-2.0
"""What 50 density requests a second cost a run: runs with and without them in turn, into docs/measurements.md.

python -m tests.benchmark.pipeline.density_under_load [INPUT] [--frames 120] [--pairs 3] [--rate 50]
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

from services.cli.ports import any_free_port
from tests.benchmark.mapstore.gateway_load import ask_steadily
from tests.benchmark.measurements_page import markdown_table, put

HEADER = ("pair", "frames/s alone", "frames/s asked", "ratio", "requests", "failed", "answer p50 / p95")


class Asking(threading.Thread):
    """Asks from the first answer until the gateway goes."""

    def __init__(self, port: int, rate: float) -> None:
        super().__init__(daemon=True)
        self._url, self._rate = f"http://127.0.0.1:{port}", rate
        self.durations_ms: list[float] = []
        self.failed = 0
        self.over = threading.Event()

    def run(self) -> None:
        """Try until somebody listens, then ask steadily."""
        while not self.durations_ms and not self.over.wait(0.2):
            self.durations_ms, self.failed = ask_steadily(self._url, self._rate, 600.0, True)


def drive(source: str, frames: int, rate: float, out: Path) -> tuple[float, Asking]:
    """Frames a second of one run, and who asked meanwhile (rate 0: nobody)."""
    port = any_free_port()
    asking = Asking(port, rate)
    if rate:
        asking.start()
    command = [sys.executable, "-m", "services.cli.app", "run", source, "--out", str(out), "--port", str(port)]
    subprocess.run([*command, "--frames", str(frames)], check=True, stdout=subprocess.DEVNULL)
    asking.over.set()
    if rate:
        asking.join(timeout=30)
    return json.loads((out / "report.json").read_text(encoding="utf-8"))["frames_per_s"], asking


def main() -> None:
    """Drive the pairs, alternating which goes first, then write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", nargs="?", default="simulator")
    parser.add_argument("--frames", type=int, default=120)
    parser.add_argument("--pairs", type=int, default=3)
    parser.add_argument("--rate", type=float, default=50.0)
    arguments = parser.parse_args()
    rows, ratios = [], []
    with tempfile.TemporaryDirectory() as folder:
        for pair in range(arguments.pairs):
            speeds: dict[bool, tuple[float, Asking]] = {}
            for asked in (False, True) if pair % 2 == 0 else (True, False):
                out = Path(folder) / f"{pair}-{asked}"
                speeds[asked] = drive(arguments.source, arguments.frames, arguments.rate if asked else 0.0, out)
            (alone, _), (asked_speed, asking) = speeds[False], speeds[True]
            ratios.append(asked_speed / alone)
            twentieths = statistics.quantiles(asking.durations_ms, n=20)
            p50, p95 = twentieths[9], twentieths[18]
            counts = [str(len(asking.durations_ms)), str(asking.failed), f"{p50:.1f} / {p95:.1f} ms"]
            rows.append([str(pair + 1), f"{alone:.2f}", f"{asked_speed:.2f}", f"{ratios[-1]:.3f}", *counts])
    rows.append(["median", "", "", f"{statistics.median(ratios):.3f}", "", "", ""])
    command = f"python -m tests.benchmark.pipeline.density_under_load {Path(arguments.source).name}"
    put("density-under-load", command, markdown_table(HEADER, rows))


if __name__ == "__main__":
    main()
