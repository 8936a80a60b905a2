# SPDX-License-Identifier: Apache-2.0
"""How much moves around a position (thesis 3.3.3, algorithm 5, with a window in time)."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from schemas.records import Density, DensityLevel, MotionState
from services.mapstore import sim3
from services.mapstore.map_view import MapView

HIGH_FROM_POINTS = 10
"""Thesis, algorithm 5: ten moving points or more are high density."""
_MOVING = int(MotionState.MOVING)
_NS_PER_S = 1_000_000_000
_FIRST_TIME_NS = -(1 << 63)


class _MovingRows(NamedTuple):
    object_id: npt.NDArray[np.uint32]
    last_seen_ns: npt.NDArray[np.int64]


class DynamicDensity:
    """Counts moving landmarks inside a sphere.

    With a window, an object counts by its last observation as moving inside the window (its ends included), once, and
    a moving landmark of no object counts where it was seen inside the window; without one (infinity) every moving
    landmark ever counts. Only the current map's landmarks can be placed, so only they count.
    """

    def __init__(self, high_from_points: int = HIGH_FROM_POINTS) -> None:
        self._high_from_points = high_from_points

    def at(self, view: MapView, position: npt.NDArray[np.float64], radius: float, window_s: float) -> Density:
        """The density around `position` (3,) in the map frame; `radius` in metres, or map units where it is not metric.

        `window_s` ends with the newest frame's time. The level is UNKNOWN where no landmark of any kind and no camera
        position lies within the radius.
        """
        keyframes = view.keyframes
        here = keyframes.map_id == view.map_id
        distance = np.linalg.norm(keyframes.bound_centre - position, axis=1)
        bound = keyframes.bound_radius
        inside = here & (bound >= 0) & (distance + bound <= radius)
        crossing = np.flatnonzero(here & (bound >= 0) & ~inside & (distance <= radius + bound * (1 + 1e-9)))
        observed = int(keyframes.counts[inside].sum())
        parts: list[_MovingRows] = []
        for row in np.flatnonzero(inside).tolist():
            if keyframes.counts[row, _MOVING]:
                parts.append(_moving(view, row, None))
        for row, within in self._members(view, crossing, position, radius):
            observed += int(np.count_nonzero(within))
            if keyframes.counts[row, _MOVING]:
                parts.append(_moving(view, row, within))
        points, objects = _count(view, parts, window_s)
        level = DensityLevel.HIGH if points >= self._high_from_points else DensityLevel.LOW
        if observed == 0 and not _camera_was_within(view, position, radius):
            level = DensityLevel.UNKNOWN
        x, y, z = position.tolist()
        return Density(
            timestamp_ns=view.timestamp_ns,
            position=(x, y, z),
            radius=radius,
            window_s=window_s,
            moving_points=points,
            moving_objects=objects,
            observed_points=observed,
            level=level,
            metric_scale=view.metric_scale,
        )

    def nowhere(self, view: MapView, radius: float, window_s: float) -> Density:
        """What is known about the density around a camera that does not know where it is."""
        nan = (math.nan, math.nan, math.nan)
        return Density(view.timestamp_ns, nan, radius, window_s, 0, 0, 0, DensityLevel.UNKNOWN, view.metric_scale)

    @staticmethod
    def _members(
        view: MapView, rows: npt.NDArray[np.intp], position: npt.NDArray[np.float64], radius: float
    ) -> list[tuple[int, npt.NDArray[np.bool_]]]:
        """For each keyframe row, which of its landmarks lie in the sphere, which goes into the keyframe's frame."""
        if len(rows) == 0:
            return []
        poses = view.keyframes.pose[rows]
        centres = sim3.transform_back(poses, np.broadcast_to(position, (len(rows), 3)))
        clusters = [view.clusters[row].position for row in rows.tolist()]
        sizes = np.array([len(cluster) for cluster in clusters])
        offset = np.concatenate(clusters) - np.repeat(centres, sizes, axis=0)
        limit = np.repeat((radius / poses[:, 7]) ** 2, sizes)
        within = np.einsum("ij,ij->i", offset, offset) <= limit
        return list(zip(rows.tolist(), np.split(within, np.cumsum(sizes)[:-1]), strict=True))


def _moving(view: MapView, row: int, within: npt.NDArray[np.bool_] | None) -> _MovingRows:
    cluster = view.clusters[row]
    moving = cluster.moving if within is None else cluster.moving[within[cluster.moving]]
    return _MovingRows(cluster.object_id[moving], cluster.last_seen_ns[moving])


def _count(view: MapView, parts: list[_MovingRows], window_s: float) -> tuple[int, int]:
    """Moving points and distinct objects among them that the window lets count."""
    if not parts:
        return 0, 0
    objects = np.concatenate([part.object_id for part in parts])
    seen_ns = np.concatenate([part.last_seen_ns for part in parts])
    if math.isinf(window_s):
        return len(objects), len(np.unique(objects[objects > 0]))
    end_ns = view.timestamp_ns
    begin_ns = max(end_ns - round(window_s * _NS_PER_S), _FIRST_TIME_NS)
    counts = (seen_ns >= begin_ns) & (seen_ns <= end_ns)
    for number in np.unique(objects[counts & (objects > 0)]).tolist():
        times = view.sightings[number]
        last_ns = times[np.searchsorted(times, end_ns, side="right") - 1]
        counts &= (objects != number) | (seen_ns == last_ns)
    return int(np.count_nonzero(counts)), len(np.unique(objects[counts & (objects > 0)]))


def _camera_was_within(view: MapView, position: npt.NDArray[np.float64], radius: float) -> bool:
    keyframes = view.keyframes
    distance = np.linalg.norm(keyframes.pose[:, :3] - position, axis=1)
    reach = keyframes.camera_reach * (1 + 1e-9)
    near = np.flatnonzero((keyframes.map_id == view.map_id) & (reach >= 0) & (distance <= radius + reach))
    for row in near.tolist():
        centres = sim3.transform(keyframes.pose[row], view.cameras[row])
        if np.any(np.linalg.norm(centres - position, axis=1) <= radius):
            return True
    return False
