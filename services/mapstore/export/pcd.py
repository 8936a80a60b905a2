# SPDX-License-Identifier: Apache-2.0
"""The map's points as binary PCD 0.7 (the Point Cloud Library's format)."""

import numpy as np
import numpy.typing as npt

from schemas.records import MotionState
from services.mapstore import sim3
from services.mapstore.map_view import MapView

STATE_RGB = {
    MotionState.STATIC: 0x2E9E44,
    MotionState.NON_MOVING: 0xF2C500,
    MotionState.MOVING: 0xE0312B,
    MotionState.UNDECIDED: 0xF2C500,
    MotionState.POTENTIALLY_DYNAMIC: 0xF2C500,
}
"""Green is background, yellow may move but was not seen to, red moves (thesis 3.3.1)."""

POINT = np.dtype(
    [
        ("x", "<f4"),
        ("y", "<f4"),
        ("z", "<f4"),
        ("rgb", "<u4"),
        ("state", "u1"),
        ("category", "<i4"),
        ("object_id", "<u4"),
    ]
)
"""One point: map frame, metres or map units; 0x00RRGGBB; MotionState; COCO category or -1; object or 0."""


def points_of(view: MapView, map_id: int) -> npt.NDArray[np.void]:
    """The points (N,) of POINT of one map, by landmark id.

    Moving landmarks are all there, each where it was seen; of the others those whose validity ended are left out.
    """
    keyframes = view.keyframes
    placed = (keyframes.map_id == map_id) & np.isfinite(keyframes.pose).all(axis=1) & (keyframes.counts.sum(axis=1) > 0)
    rows = np.flatnonzero(placed).tolist()
    clusters = [view.clusters[row] for row in rows]
    points = np.empty(sum(len(cluster) for cluster in clusters), dtype=POINT)
    if len(points) == 0:
        return points
    sizes = [len(cluster) for cluster in clusters]
    local = np.concatenate([cluster.position for cluster in clusters]).astype(np.float64)
    in_map = sim3.transform(np.repeat(keyframes.pose[rows], sizes, axis=0), local)
    for axis, name in enumerate("xyz"):
        points[name] = in_map[:, axis]
    points["state"] = np.concatenate([cluster.state for cluster in clusters])
    points["category"] = np.concatenate([cluster.category for cluster in clusters])
    points["object_id"] = np.concatenate([cluster.object_id for cluster in clusters])
    colours = np.zeros(256, dtype=np.uint32)
    colours[list(STATE_RGB)] = list(STATE_RGB.values())
    points["rgb"] = colours[points["state"]]
    ended = np.concatenate([cluster.valid_until_ns for cluster in clusters]) >= 0
    order = np.argsort(np.concatenate([cluster.landmark_id for cluster in clusters]))
    present = ~(ended & (points["state"] != MotionState.MOVING))
    chosen: npt.NDArray[np.void] = points[order[present[order]]]
    return chosen


def map_pcd(view: MapView, map_id: int) -> bytes:
    """The file: the same bytes for the same map."""
    points = points_of(view, map_id)
    scale = "metres" if view.metric_scale else "map units (scale arbitrary)"
    header = (
        f"# .PCD v0.7 - kinemap, map frame, {scale}\n"
        "VERSION 0.7\n"
        "FIELDS x y z rgb state category object_id\n"
        "SIZE 4 4 4 4 1 4 4\n"
        "TYPE F F F U U I U\n"
        "COUNT 1 1 1 1 1 1 1\n"
        f"WIDTH {len(points)}\n"
        "HEIGHT 1\n"
        "VIEWPOINT 0 0 0 1 0 0 0\n"
        f"POINTS {len(points)}\n"
        "DATA binary\n"
    )
    return header.encode("ascii") + points.tobytes()
