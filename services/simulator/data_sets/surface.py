# SPDX-License-Identifier: Apache-2.0
"""What stands in a drive, as labelled points: depth images back-projected, one point a voxel."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from schemas.records import MotionState
from services.formats.point_cloud import first_in_voxels
from services.simulator.frame import SimulatedFrame

VOXEL_M = 0.1
FARTHEST_M = 40.0
"""Neighbouring pixels of the default lens lie a voxel apart there."""
EVERY_FRAMES = 5
"""Half a second of way between the frames that are looked at."""

POINT = np.dtype(
    [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("red", "u1"), ("green", "u1"), ("blue", "u1"), ("state", "u1")]
)
"""Metres; the pixel's colour; MotionState: static (0) or non_moving (1)."""

_PLY_TYPES = {"<f4": "float", "|u1": "uchar"}


def frame_surface(
    frame: SimulatedFrame, k: NDArray[np.float64], reference_from_world: NDArray[np.float64]
) -> NDArray[np.void]:
    """The points (N,) of POINT that one frame sees of what stands at its time, in the reference frame.

    k: calibration matrix (3, 3) in px. Sky, what moves, and what is farther than `FARTHEST_M` are left out.
    """
    moving = [instance.instance_id for instance in frame.instances if instance.moving]
    chosen = (frame.depth_m > 0.0) & (frame.depth_m <= FARTHEST_M) & ~np.isin(frame.labels, moving)
    rows, columns = np.nonzero(chosen)
    depth = frame.depth_m[chosen].astype(np.float64)
    in_camera = np.stack([(columns - k[0, 2]) / k[0, 0] * depth, (rows - k[1, 2]) / k[1, 1] * depth, depth], axis=1)
    reference_from_camera = reference_from_world @ frame.world_from_camera
    place = in_camera @ reference_from_camera[:3, :3].T + reference_from_camera[:3, 3]
    points = np.empty(len(place), POINT)
    for axis, name in enumerate("xyz"):
        points[name] = place[:, axis]
    for channel, name in enumerate(("blue", "green", "red")):
        points[name] = frame.image[..., channel][chosen]
    points["state"] = np.where(frame.labels[chosen] > 0, MotionState.NON_MOVING, MotionState.STATIC)
    return thinned([points])


def thinned(clouds: Iterable[NDArray[np.void]]) -> NDArray[np.void]:
    """The first point in every voxel of `VOXEL_M` and state, in the order in which they came."""
    points = np.concatenate([*clouds, np.empty(0, POINT)])
    place = np.stack([points[name] for name in "xyz"], axis=1)
    return points[first_in_voxels(place, points["state"], VOXEL_M)]


def write_ply(path: Path, points: NDArray[np.void], frame_note: str) -> None:
    """Write POINTs as binary PLY (Turk, Stanford 1994); `frame_note` says which frame of reference they are in."""
    lines = ["ply", "format binary_little_endian 1.0", f"comment {frame_note}"]
    lines += ["comment state: 0 static, 1 non_moving", f"element vertex {len(points)}"]
    for name in POINT.names or ():
        lines.append(f"property {_PLY_TYPES[POINT[name].str]} {name}")
    path.write_bytes("\n".join([*lines, "end_header", ""]).encode("ascii") + points.tobytes())
