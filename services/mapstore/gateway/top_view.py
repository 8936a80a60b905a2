# SPDX-License-Identifier: Apache-2.0
"""The map seen from above, small enough to send every second."""

import numpy as np

from services.mapstore import sim3
from services.mapstore.map_view import MapView

MOST_POINTS = 20_000
MOST_POSES = 5_000


def top_view(view: MapView) -> bytes:
    """Little-endian: uint32 point count, uint32 pose count, float32 x y state per point, float32 x y per pose.

    Of each keyframe every n-th landmark, so that at most about MOST_POINTS come together; of the current map only.
    """
    keyframes = view.keyframes
    placed = (keyframes.map_id == view.map_id) & np.isfinite(keyframes.pose).all(axis=1)
    rows = np.flatnonzero(placed & (keyframes.counts.sum(axis=1) > 0))
    step = 1 + int(keyframes.counts[rows].sum()) // MOST_POINTS
    clusters = [view.clusters[row] for row in rows.tolist()]
    points = np.empty((sum(len(range(0, len(cluster), step)) for cluster in clusters), 3), dtype="<f4")
    if clusters:
        sizes = [len(range(0, len(cluster), step)) for cluster in clusters]
        local = np.concatenate([cluster.position[::step] for cluster in clusters]).astype(np.float64)
        points[:, :2] = sim3.transform(np.repeat(keyframes.pose[rows], sizes, axis=0), local)[:, :2]
        points[:, 2] = np.concatenate([cluster.state[::step] for cluster in clusters])
    way = view.final_poses()[view.frame_map_ids() == view.map_id, :2]
    way = way[np.isfinite(way).all(axis=1)]
    way = way[:: 1 + len(way) // MOST_POSES].astype("<f4")
    return np.array([len(points), len(way)], dtype="<u4").tobytes() + points.tobytes() + way.tobytes()
