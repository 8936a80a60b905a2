# SPDX-License-Identifier: Apache-2.0
"""The objects of the map, by their landmarks and cuboids: what each one is and where it was seen last."""

from dataclasses import dataclass

import numpy as np

from schemas.categories import category_name
from schemas.records import MappedObject, MotionState
from services.mapstore import sim3
from services.mapstore.map_view import MapView


@dataclass(frozen=True)
class ObjectSummary:
    """One object of the current map, as its cuboid in the newest frame has it, else its most recent landmarks."""

    object_id: int
    category: str
    """COCO's name; empty where it is not known"""
    state: MotionState
    landmarks: int
    """of all time"""
    position: tuple[float, float, float]
    """middle of the cuboid, else of the landmarks seen last; map frame, metres or map units"""
    first_seen_ns: int
    """when its oldest landmark was; the newest frame's time where it has none"""
    last_seen_ns: int
    cuboid: MappedObject | None = None
    """only for what the newest frame shows, in a metric map"""


def summarize_objects(view: MapView) -> list[ObjectSummary]:
    """Every object with a landmark in the current map or a cuboid in the newest frame, by id."""
    summaries = {summary.object_id: summary for summary in _by_landmarks(view)}
    for cuboid in view.objects:
        known = summaries.get(cuboid.object_id)
        summaries[cuboid.object_id] = ObjectSummary(
            object_id=cuboid.object_id,
            category=cuboid.category,
            state=cuboid.motion_state,
            landmarks=0 if known is None else known.landmarks,
            position=cuboid.position,
            first_seen_ns=view.timestamp_ns if known is None else known.first_seen_ns,
            last_seen_ns=view.timestamp_ns,
            cuboid=cuboid,
        )
    return [summaries[number] for number in sorted(summaries)]


def _by_landmarks(view: MapView) -> list[ObjectSummary]:
    keyframes = view.keyframes
    placed = (keyframes.map_id == view.map_id) & np.isfinite(keyframes.pose).all(axis=1)
    rows = [row for row in np.flatnonzero(placed).tolist() if view.clusters[row].object_id.any()]
    if not rows:
        return []
    clusters = [view.clusters[row] for row in rows]
    belongs = [np.flatnonzero(cluster.object_id) for cluster in clusters]
    keyframe = np.repeat(rows, [len(members) for members in belongs])
    parts = list(zip(clusters, belongs, strict=True))
    object_id = np.concatenate([cluster.object_id[members] for cluster, members in parts])
    last_seen_ns = np.concatenate([cluster.last_seen_ns[members] for cluster, members in parts])
    first_seen_ns = np.concatenate([cluster.first_seen_ns[members] for cluster, members in parts])
    state = np.concatenate([cluster.state[members] for cluster, members in parts])
    category = np.concatenate([cluster.category[members] for cluster, members in parts])
    local = np.concatenate([cluster.position[members] for cluster, members in parts]).astype(np.float64)
    position = sim3.transform(keyframes.pose[keyframe], local)
    order = np.lexsort((last_seen_ns, object_id))
    numbers, starts = np.unique(object_id[order], return_index=True)
    summaries = []
    for number, members in zip(numbers.tolist(), np.split(order, starts[1:]), strict=True):
        newest = members[-1]
        x, y, z = position[members[last_seen_ns[members] == last_seen_ns[newest]]].mean(axis=0).tolist()
        summaries.append(
            ObjectSummary(
                object_id=number,
                category=category_name(int(category[newest])),
                state=MotionState(int(state[newest])),
                landmarks=len(members),
                position=(x, y, z),
                first_seen_ns=int(first_seen_ns[members].min()),
                last_seen_ns=int(last_seen_ns[newest]),
            )
        )
    return summaries
