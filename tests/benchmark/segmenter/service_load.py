# SPDX-License-Identifier: Apache-2.0
"""What the segmenter service holds, drops and needs over a long drive, in both ways to deliver.

    python -m tests.benchmark.segmenter.service_load INPUT [--frames 2000] [--every 8] [--weights FILE] [--write]

Runs of the whole pipeline with the network: `lossless` with every Nth frame segmented; `realtime`, at the rate of the
input, with every frame, more than a CPU can do; and with as many as there is time for. Memory is that of the service's
process, looked at every second.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import psutil

from services.formats.session import SessionFile
from services.runtime.process_table import PROCESSES
from tests.benchmark.measurements_page import markdown_table, put

HEADER = (
    "delivery",
    "frames sent",
    "answered",
    "given up by rule",
    "held at most",
    "ms a frame p50, p95",
    "memory after a tenth, MiB",
    "at the end, MiB",
    "most, MiB",
)
MIB = 1 << 20


class Load(NamedTuple):
    """Of one run."""

    sent: int
    answered: int
    metrics: dict[str, float]
    memory_bytes: list[int]


def drive(source: str, frames: int, settings: list[str], out: Path) -> Load:
    """Run, and look at the segmenter's memory meanwhile."""
    command = [sys.executable, "-m", "services.cli.app", "run", source, "--out", str(out), "--port", "0"]
    module = next(process.module for process in PROCESSES if process.name == "segmenter")
    memory: list[int] = []
    with subprocess.Popen([*command, "--frames", str(frames), *settings]) as run:
        while run.poll() is None:
            memory += _memory(module, out)
            time.sleep(1.0)
    if run.returncode:
        raise SystemExit(f"the run ended with {run.returncode}, expected 0")
    with SessionFile(out / "session.mcap") as file:
        counts = file.message_counts()
    usage = json.loads((out / "services.json").read_text(encoding="utf-8"))["segmenter"]["metrics"]
    return Load(counts["camera/image"], counts["segmenter/instances"], usage, memory)


def _memory(module: str, folder: Path) -> list[int]:
    for process in psutil.process_iter(["cmdline", "memory_info"]):
        line = " ".join(process.info["cmdline"] or [])
        if f"-m {module} " in line and str(folder) in line and process.info["memory_info"] is not None:
            return [process.info["memory_info"].rss]
    return []


def main() -> None:
    """All runs, then the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", metavar="INPUT")
    parser.add_argument("--frames", type=int, default=2000)
    parser.add_argument("--every", type=int, default=8)
    parser.add_argument("--weights", help="a file or a name of `kinemap weights`; what runs by default otherwise")
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    common = ["--set", "segmenter.backend=solov2"]
    if arguments.weights:
        common += ["--set", f"segmenter.weights={arguments.weights}"]
    ways = {
        f"lossless, every {arguments.every}th": ["--set", f"segmenter.every={arguments.every}"],
        "realtime, every frame": ["--set", "delivery.mode=realtime", "--set", "segmenter.every=1"],
        "realtime, as there is time": ["--set", "delivery.mode=realtime"],
    }
    rows = []
    for name, settings in ways.items():
        with tempfile.TemporaryDirectory() as folder:
            load = drive(arguments.source, arguments.frames, [*common, *settings], Path(folder) / "run")
        values = load.metrics
        dropped = values.get("frames_dropped", 0.0) + values.get("dropped camera/image", 0.0)
        rows.append(
            (
                name,
                str(load.sent),
                str(load.answered),
                f"{dropped:.0f}",
                f"{values['frames_held']:.0f}",
                f"{values['process_ms_p50']:.0f}, {values['process_ms_p95']:.0f}",
                *(
                    f"{value / MIB:.0f}"
                    for value in (
                        load.memory_bytes[len(load.memory_bytes) // 10],
                        load.memory_bytes[-1],
                        max(load.memory_bytes),
                    )
                ),
            )
        )
    table = markdown_table(HEADER, rows)
    if arguments.write:
        put("segmenter-load", "python -m tests.benchmark.segmenter.service_load INPUT --write", table)
    else:
        print(table)


if __name__ == "__main__":
    main()
