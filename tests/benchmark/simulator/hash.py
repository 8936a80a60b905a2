# SPDX-License-Identifier: Apache-2.0
"""One number for a drive: `python -m tests.benchmark.simulator.hash [--frames 100] [name=value ...]`.

Prints the SHA-256 of the first frames of the drive with these options: images, depth, labels, poses, what is true of
the objects, and flow. Equal options print equal numbers on one kind of machine, whatever the threads and the load.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
from typing import Any

from services.simulator.drive import Drive
from services.simulator.frame import SimulatedFrame
from services.simulator.options import DriveOptions


def add_frame(total: Any, frame: SimulatedFrame) -> None:
    """Add everything that a frame holds to a hash."""
    images = [frame.image] + ([] if frame.image_right is None else [frame.image_right])
    for array in (*images, frame.depth_m, frame.labels, frame.world_from_camera):
        total.update(array.tobytes())
    for found in frame.instances:
        values = found.instance_id, found.category, found.moving, found.box_px, found.visible_px, found.size_m
        total.update(repr((frame.timestamp_ns, *values)).encode())
        total.update(found.velocity_m_s.tobytes() + found.position_m.tobytes())


def drive_hash(options: DriveOptions, frames: int) -> str:
    """SHA-256 of the first `frames` frames of a drive and the flow between them."""
    drive, total = Drive(options), hashlib.sha256()
    for index in range(frames):
        add_frame(total, drive.render(index))
        if index + 1 < min(frames, drive.frame_count):
            flow = drive.flow(index)
            total.update(flow.flow_px.tobytes() + flow.visible.tobytes())
    return total.hexdigest()


def main() -> None:
    """Print the number."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("options", nargs="*", help="of the drive, as name=value")
    asked = parser.parse_args()
    given = {}
    for one in asked.options:
        name, _, value = one.partition("=")
        try:
            given[name] = ast.literal_eval(value)
        except (ValueError, SyntaxError):
            given[name] = value
    print(drive_hash(DriveOptions(**given), asked.frames))


if __name__ == "__main__":
    main()
