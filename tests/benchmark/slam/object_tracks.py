# SPDX-License-Identifier: Apache-2.0
"""How well objects are placed in the map: simulated drives, the simulator's own masks and flags, against its truth.

python -m tests.benchmark.slam.object_tracks [--world town] [--seeds 1] [--frames 150] [--traffic 0.5] [--write]
"""

import argparse
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from schemas.codec.rigid import matrix_from_pose
from schemas.records import CameraCalibration, DepthImage, Image, MaskSource, MotionState, Objects, ObjectTrack
from schemas.records.mapped_objects import MappedObjects
from services.simulator.drive import Drive
from services.simulator.frame import SimulatedFrame, SimulatedInstance
from services.simulator.options import DriveOptions
from services.slam.engine_adapter import EngineSettings, SlamEngine
from tests.benchmark.measurements_page import put

Array = npt.NDArray[np.float64]

NEAR_M = 30.0
SETTLED_FRAMES = 5
"""An object's velocity is compared from its so many-th sighting on."""


@dataclass
class Errors:
    """Of all objects of one kind."""

    position_share: list[float] = field(default_factory=list)
    """distance from the truth / distance from the camera"""
    position_m: list[float] = field(default_factory=list)
    velocity_m_s: list[float] = field(default_factory=list)
    normalized: list[float] = field(default_factory=list)
    """distance from the truth / stated standard deviation"""

    def row(self, name: str) -> str:
        """One line of the table."""
        if not self.position_m or not self.velocity_m_s:
            return f"| {name} | 0 | - | - | - | - | - |"
        share, metres, speed = np.array(self.position_share), np.array(self.position_m), np.array(self.velocity_m_s)
        return (
            f"| {name} | {len(metres)} | {100 * np.median(share):.1f} % | {np.median(metres):.2f} m "
            f"| {np.median(speed):.2f} m/s | {np.percentile(speed, 90):.2f} m/s | {np.median(self.normalized):.2f} |"
        )


def objects_of(frame: SimulatedFrame) -> Objects:
    """The simulator's instances as if the tracker had seen them without fault."""
    rows = tuple(
        ObjectTrack(
            seen.instance_id,
            seen.category,
            1.0,
            MotionState.MOVING if seen.moving else MotionState.NON_MOVING,
            1.0 if seen.moving else 0.0,
            tuple(float(side) for side in seen.box_px),  # type: ignore[arg-type]
            1,
        )
        for seen in frame.instances
    )
    return Objects(frame.timestamp_ns, frame.labels.astype(np.uint32), rows)


def compare(
    mapped: MappedObjects,
    map_from_camera: Array,
    frame: SimulatedFrame,
    sightings: dict[int, int],
    errors: dict[str, Errors],
) -> None:
    """Adds one frame's errors; what the camera's own pose is wrong by does not count."""
    world_from_map = frame.world_from_camera @ np.linalg.inv(map_from_camera)
    truth: dict[int, SimulatedInstance] = {seen.instance_id: seen for seen in frame.instances}
    camera = frame.world_from_camera[:3, 3]
    for found in mapped.objects:
        seen = truth[found.object_id]
        sightings[found.object_id] = sightings.get(found.object_id, 0) + 1
        distance_m = float(np.linalg.norm(seen.position_m - camera))
        height, width = frame.labels.shape
        x, y, across, down = seen.box_px
        is_cut = x <= 1 or x + across >= width - 1 or y + down >= height - 1
        if distance_m > NEAR_M or is_cut:
            continue
        position = (world_from_map @ np.append(found.position, 1.0))[:3]
        velocity = world_from_map[:3, :3] @ np.array(found.velocity)
        off_m = float(np.linalg.norm(position - seen.position_m))
        what = "person" if seen.category == "person" else "vehicle"
        kind = errors[f"{what}, {'moving' if seen.moving else 'standing'}"]
        kind.position_m.append(off_m)
        kind.position_share.append(off_m / distance_m)
        kind.normalized.append(off_m / found.position_sigma)
        if sightings[found.object_id] >= SETTLED_FRAMES:
            kind.velocity_m_s.append(float(np.linalg.norm(velocity - seen.velocity_m_s)))


def run(options: DriveOptions, use_depth: bool) -> dict[str, Errors]:
    """One drive, with one camera of known height or with depth images."""
    drive = Drive(options)
    camera = drive.camera
    calibration = CameraCalibration(
        0, camera.width, camera.height, camera.k, camera.lens.coefficients, None, "camera", camera.lens.model
    )
    height_m = 0.0 if use_depth else options.camera_height_m
    engine = SlamEngine(calibration, EngineSettings(camera_height_m=height_m))
    kinds = [f"{what}, {how}" for what in ("vehicle", "person") for how in ("moving", "standing")]
    errors = {kind: Errors() for kind in kinds}
    sightings: dict[int, int] = {}
    for index in range(drive.frame_count):
        frame = drive.render(index)
        depth = DepthImage(frame.timestamp_ns + 1, frame.depth_m) if use_depth else None
        engine.begin_frame(Image(frame.timestamp_ns + 1, frame.image), None, depth)
        tracked = engine.finish_frame(objects_of(frame), MaskSource.FRESH)
        engine.take_map_update(tracked.timestamp_ns)
        if tracked.map_from_camera is not None:
            compare(engine.mapped_objects, matrix_from_pose(tracked.map_from_camera), frame, sightings, errors)
    return errors


def table(title: str, results: Iterable[dict[str, Errors]]) -> str:
    """Markdown of several drives together."""
    together: dict[str, Errors] = {}
    for result in results:
        for kind, errors in result.items():
            into = together.setdefault(kind, Errors())
            for name in ("position_share", "position_m", "velocity_m_s", "normalized"):
                getattr(into, name).extend(getattr(errors, name))
    lines = [
        f"| {title}, within {NEAR_M:.0f} m | sightings | position off, of distance | in metres "
        "| velocity off | p90 | off / sigma |",
        "|---|---|---|---|---|---|---|",
        *(errors.row(kind) for kind, errors in together.items()),
    ]
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--world", choices=["street", "town", "corridor"], default="town")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--frames", type=int, default=150)
    parser.add_argument("--traffic", type=float, default=0.5)
    parser.add_argument("--width", type=int, default=640)
    parser.add_argument("--height", type=int, default=192)
    parser.add_argument("--write", action="store_true", help="put the tables on docs/measurements.md")
    arguments = parser.parse_args()
    tables = []
    for title, use_depth in (("one camera of known height", False), ("depth images", True)):
        results = [
            run(
                DriveOptions(
                    world=arguments.world,
                    seed=seed,
                    frames=arguments.frames,
                    traffic=arguments.traffic,
                    width=arguments.width,
                    height=arguments.height,
                ),
                use_depth,
            )
            for seed in range(1, arguments.seeds + 1)
        ]
        tables.append(table(title, results))
        print(tables[-1], "\n")
    if arguments.write:
        command = f"python -m tests.benchmark.slam.object_tracks --world {arguments.world} --seeds {arguments.seeds}"
        command += f" --frames {arguments.frames} --traffic {arguments.traffic} --write"
        put("object-tracks", command, "\n\n".join(tables))


if __name__ == "__main__":
    main()
