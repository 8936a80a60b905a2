# SPDX-License-Identifier: Apache-2.0
"""What the simulator costs: `python tests/benchmark/simulator/speed.py [WIDTHxHEIGHT] [THREADS]`.

Prints seconds to import and build, milliseconds a frame (wall clock and processor), and the largest memory. Alone on
two cores the default drive should stay below 100 ms a frame with one thread, 2.5 s to build and 600 MB.
"""

from __future__ import annotations

import resource
import sys
import time

import cv2
import numpy as np


def main(size: str = "640x192", threads: str = "1") -> None:
    """Render every eighth frame of the default drive and print what it took."""
    cv2.setNumThreads(int(threads))
    start = time.perf_counter()
    from services.simulator.drive import Drive
    from services.simulator.options import DriveOptions

    width, height = (int(side) for side in size.split("x"))
    street = Drive(DriveOptions(width=width, height=height, threads=int(threads)))
    built = time.perf_counter()
    wall_ms, cpu_ms = [], []
    for index in range(0, street.frame_count, 8):
        wall, cpu = time.perf_counter(), time.process_time()
        street.render(index)
        wall_ms.append(1e3 * (time.perf_counter() - wall))
        cpu_ms.append(1e3 * (time.process_time() - cpu))
    memory_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f"{size}, {threads} thread(s): import and build {built - start:.2f} s, largest memory {memory_mb:.0f} MB")
    for name, values in (("wall", wall_ms), ("processor", cpu_ms)):
        print(
            f"  {name}: median {np.median(values):.1f} ms, 95th percentile {np.percentile(values, 95):.1f} ms a frame"
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
