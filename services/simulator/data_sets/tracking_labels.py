# SPDX-License-Identifier: Apache-2.0
"""A frame's objects as KITTI's tracking devkit wants them (its readme.txt)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from services.formats.kitti_tracking import TrackedBox
from services.simulator.actors.actor import Actor, ActorState
from services.simulator.data_sets.silhouette import Silhouette, silhouette
from services.simulator.drive import Drive
from services.simulator.frame import SimulatedFrame, SimulatedInstance

Floats = NDArray[np.float64]

_TYPES = {"car": "Car", "truck": "Truck", "person": "Pedestrian"}
_CYCLIST, _OTHER = "Cyclist", "Misc"
_RIDDEN = ("bicycle", "motorcycle")
_RIDER_WITHIN_M = 0.6

_TRUNCATED = (0.02, 0.5)
_OCCLUDED = (0.1, 0.5)


class TrackingLabels:
    """Boxes of a drive's objects in the left camera's frame (x right, y down, z forward), metres and px.

    truncated: 0 within the image, 1 less than half beyond its border, 2 more. occluded: 0 when less than a tenth of
    what lies in the image is hidden, 1 less than half, 2 more. The 2D box holds the hidden parts too, as KITTI's do.
    A bicycle and who rides it are one `Cyclist` with the bicycle's id; buses, and bicycles alone, are `Misc`.
    """

    def __init__(self, drive: Drive) -> None:
        self._drive = drive
        self._actor = {actor.instance_id: actor for actor in drive.actors}
        self._rider = _riders(drive)
        self._ridden = {rider: ridden for ridden, rider in self._rider.items()}

    def boxes(self, frame: SimulatedFrame) -> dict[int, TrackedBox]:
        """The labels by the id of the instance that has one; who rides has none of his own unless he alone is seen."""
        seen = {instance.instance_id: instance for instance in frame.instances}
        boxes = {}
        for number, instance in seen.items():
            ridden = self._ridden.get(number)
            if ridden in seen:
                continue
            main = number if ridden is None else ridden
            group = [main] + ([self._rider[main]] if main in self._rider else [])
            boxes[number] = self._box(frame, instance, group, [seen[member] for member in group if member in seen])
        return boxes

    def _box(
        self,
        frame: SimulatedFrame,
        instance: SimulatedInstance,
        group: list[int],
        seen: list[SimulatedInstance],
    ) -> TrackedBox:
        t_s = frame.timestamp_ns * 1e-9
        members = [(self._actor[number], self._actor[number].at(t_s)) for number in group]
        camera_from_world: Floats = np.linalg.inv(frame.world_from_camera).astype(np.float64)
        whole = silhouette(self._drive.camera, _corners(members, camera_from_world))
        length_m, width_m, _ = members[0][0].size_m
        bottom_m = members[0][1].centre_m[2] - 0.5 * members[0][0].size_m[2]
        height_m = max(state.centre_m[2] + 0.5 * actor.size_m[2] for actor, state in members) - bottom_m
        place = camera_from_world[:3, :3] @ [*members[0][1].centre_m[:2], bottom_m] + camera_from_world[:3, 3]
        heading = members[0][1].heading_rad
        ahead = camera_from_world[:3, :3] @ [math.cos(heading), math.sin(heading), 0.0]
        rotation_y = math.atan2(-ahead[2], ahead[0])
        alpha = rotation_y - math.atan2(place[0], place[2])
        return TrackedBox(
            frame.index,
            group[0],
            _CYCLIST if len(group) > 1 else _TYPES.get(instance.category, _OTHER),
            _around([item.box_px for item in seen], whole),
            _truncated(whole),
            _occluded(sum(item.visible_px for item in seen), whole),
            math.remainder(alpha, math.tau),
            (float(height_m), width_m, length_m),
            (float(place[0]), float(place[1]), float(place[2])),
            rotation_y,
        )


def _riders(drive: Drive) -> dict[int, int]:
    """Who sits on what, (ridden: rider), by being in one place at the drive's start, middle and end."""
    times_s = [drive.timestamp_ns(index) * 1e-9 for index in (0, drive.frame_count // 2, drive.frame_count - 1)]
    people = [actor for actor in drive.actors if actor.category == "person"]
    places = np.array([[actor.at(t).centre_m[:2] for t in times_s] for actor in people]).reshape(-1, len(times_s), 2)
    riders = {}
    for ridden in (actor for actor in drive.actors if actor.category in _RIDDEN):
        own = np.array([ridden.at(t).centre_m[:2] for t in times_s])
        near = np.flatnonzero((np.linalg.norm(places - own, axis=2) < _RIDER_WITHIN_M).all(axis=1))
        if len(near):
            riders[ridden.instance_id] = people[near[0]].instance_id
    return riders


def _corners(members: Sequence[tuple[Actor, ActorState]], camera_from_world: Floats) -> Floats:
    corners = np.concatenate([actor.vertices_in_world(state)[actor.mesh.triangles] for actor, state in members])
    return np.asarray(corners @ camera_from_world[:3, :3].T + camera_from_world[:3, 3])


def _around(
    boxes_px: Sequence[tuple[int, int, int, int]], whole: Silhouette | None
) -> tuple[float, float, float, float]:
    edges = [(float(x), float(y), float(x + width - 1), float(y + height - 1)) for x, y, width, height in boxes_px]
    lefts, tops, rights, bottoms = zip(*edges, *([whole.box_px] if whole else []), strict=True)
    return min(lefts), min(tops), max(rights), max(bottoms)


def _truncated(whole: Silhouette | None) -> int:
    return _level(1.0 if whole is None else 1.0 - whole.inside_px / whole.whole_px, _TRUNCATED)


def _occluded(visible_px: int, whole: Silhouette | None) -> int:
    # Near enough to reach behind the camera, it is before everything else.
    return _level(0.0 if whole is None else 1.0 - visible_px / whole.inside_px, _OCCLUDED)


def _level(share: float, limits: tuple[float, float]) -> int:
    return int(np.searchsorted(limits, share, side="right"))
