# SPDX-License-Identifier: Apache-2.0
"""The semi-dense map as binary PCD 0.7, labelled like the sparse one."""

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from schemas.records import MotionState
from services.mapstore import sim3
from services.mapstore.dense_table import DenseCloud
from services.mapstore.export.pcd import POINT, STATE_RGB
from services.mapstore.map_view import MapView

DENSE_POINT = np.dtype([*POINT.descr, ("grey", "u1"), ("sigma", "<f4"), ("t_s", "<f8")])
"""POINT, whose colour is darker where the image is; the image's grey value; the standard deviation along the line of
sight, metres or map units; when it was seen, seconds."""
_DARKEST = 0.25


def dense_points_of(view: MapView, clouds: Iterable[DenseCloud], map_id: int) -> npt.NDArray[np.void]:
    """The points (N,) of DENSE_POINT of one map, by keyframe.

    Points on an object that stood and later drove off are left out, as their landmarks are.
    """
    keyframes = view.keyframes
    row_of = {number: row for row, number in enumerate(keyframes.id.tolist())}
    left_at_ns = _departures(view)
    parts = [np.empty(0, DENSE_POINT)]
    for cloud in clouds:
        row = row_of.get(cloud.keyframe_id)
        if row is None or keyframes.map_id[row] != map_id or not np.isfinite(keyframes.pose[row]).all():
            continue
        seen_ns = int(keyframes.timestamp_ns[row])
        gone = [number for number, time_ns in left_at_ns.items() if time_ns >= seen_ns]
        present = ~(np.isin(cloud.object_id, gone) & (cloud.state != MotionState.MOVING))
        parts.append(_placed(cloud, keyframes.pose[row], seen_ns)[present])
    return np.concatenate(parts)


def dense_pcd(points: npt.NDArray[np.void], metric_scale: bool) -> bytes:
    """The file: the same bytes for the same points."""
    scale = "metres" if metric_scale else "map units (scale arbitrary)"
    header = (
        f"# .PCD v0.7 - kinemap, semi-dense, map frame, {scale}\n"
        "VERSION 0.7\n"
        "FIELDS x y z rgb state category object_id grey sigma t_s\n"
        "SIZE 4 4 4 4 1 4 4 1 4 8\n"
        "TYPE F F F U U I U U F F\n"
        "COUNT 1 1 1 1 1 1 1 1 1 1\n"
        f"WIDTH {len(points)}\n"
        "HEIGHT 1\n"
        "VIEWPOINT 0 0 0 1 0 0 0\n"
        f"POINTS {len(points)}\n"
        "DATA binary\n"
    )
    return header.encode("ascii") + points.tobytes()


def _placed(cloud: DenseCloud, map_from_keyframe: sim3.Floats, seen_ns: int) -> npt.NDArray[np.void]:
    points = np.zeros(len(cloud.grey), DENSE_POINT)
    local = cloud.position.astype(np.float64)
    in_map = sim3.transform(np.broadcast_to(map_from_keyframe, (len(local), 8)), local)
    for axis, name in enumerate("xyz"):
        points[name] = in_map[:, axis]
    for name in ("state", "category", "object_id", "grey"):
        points[name] = getattr(cloud, name)
    points["sigma"] = map_from_keyframe[7] * cloud.depth_sigma
    points["t_s"] = seen_ns * 1e-9
    colours = np.zeros(256, dtype=np.uint32)
    colours[list(STATE_RGB)] = list(STATE_RGB.values())
    brightness = _DARKEST + (1 - _DARKEST) * cloud.grey / 255
    for shift in (0, 8, 16):
        channel = (colours[cloud.state] >> shift) & 0xFF
        points["rgb"] |= np.rint(channel * brightness).astype(np.uint32) << shift
    return points


def _departures(view: MapView) -> dict[int, int]:
    """When each object that stood drove off, by the end of its landmarks' validity."""
    left_at_ns: dict[int, int] = {}
    for cluster in view.clusters:
        ended = (cluster.valid_until_ns >= 0) & (cluster.object_id > 0)
        for number, time_ns in zip(
            cluster.object_id[ended].tolist(), cluster.valid_until_ns[ended].tolist(), strict=True
        ):
            left_at_ns[number] = max(time_ns, left_at_ns.get(number, time_ns))
    return left_at_ns
