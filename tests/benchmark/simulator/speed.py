# SPDX-License-Identifier: Apache-2.0
"""What the simulator costs: `python -m tests.benchmark.simulator.speed [WORLD WIDTHxHEIGHT THREADS SHADOWS]`.

Without arguments it measures every world, size, number of threads, with and without shadows, each in a process of its
own, and puts the table into docs/measurements.md; alone on the machine, or the numbers are somebody else's.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time
from pathlib import Path

import cv2
import numpy as np

_WORLDS = ("street", "town", "corridor")
_SIZES = ("640x192", "1242x375")
_EVERY = 8
_HEADER = [
    "World",
    "Size",
    "Threads",
    "Shadows",
    "Import and build, s",
    "Frame, ms (median)",
    "95th percentile",
    "Processor, ms",
    "Frames/s",
    "Memory, MB",
]


def measure(world: str, size: str, threads: int, shadows: bool) -> dict[str, float]:
    """Render every eighth frame of a default drive."""
    cv2.setNumThreads(threads)
    start = time.perf_counter()
    from services.simulator.drive import Drive
    from services.simulator.options import DriveOptions

    width, height = (int(side) for side in size.split("x"))
    drive = Drive(DriveOptions(world=world, width=width, height=height, threads=threads, shadows=shadows))
    built = time.perf_counter()
    drive.render(0)
    wall_ms, cpu_ms = [], []
    for index in range(4, drive.frame_count, _EVERY):
        wall, cpu = time.perf_counter(), time.process_time()
        drive.render(index)
        wall_ms.append(1e3 * (time.perf_counter() - wall))
        cpu_ms.append(1e3 * (time.process_time() - cpu))
    return {
        "build_s": built - start,
        "median_ms": float(np.median(wall_ms)),
        "p95_ms": float(np.percentile(wall_ms, 95)),
        "cpu_ms": float(np.median(cpu_ms)),
        "memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    }


def main() -> None:
    """Measure everything, each in a fresh process."""
    from tests.benchmark.measurements_page import markdown_table, put

    rows = []
    for world in _WORLDS:
        for size in _SIZES:
            for threads, shadows in ((1, False), (2, False), (2, True)):
                given = [world, size, str(threads), str(int(shadows))]
                command = [sys.executable, "-m", "tests.benchmark.simulator.speed", *given]
                root = Path(__file__).resolve().parents[3]
                done = subprocess.run(command, cwd=root, stdout=subprocess.PIPE, text=True, check=True)
                found = json.loads(done.stdout)
                times = [found["build_s"], found["median_ms"], found["p95_ms"], found["cpu_ms"]]
                rates = [1e3 / found["median_ms"], found["memory_mb"]]
                texts = [f"{times[0]:.1f}", *(f"{value:.0f}" for value in times[1:])]
                rows.append(
                    [world, size, str(threads), "yes" if shadows else "no", *texts, *(f"{v:.0f}" for v in rates)]
                )
                print(rows[-1], file=sys.stderr, flush=True)
    put("simulator-speed", "python -m tests.benchmark.simulator.speed", markdown_table(_HEADER, rows))


if __name__ == "__main__":
    if len(sys.argv) == 5:
        print(json.dumps(measure(sys.argv[1], sys.argv[2], int(sys.argv[3]), bool(int(sys.argv[4])))))
    else:
        main()
