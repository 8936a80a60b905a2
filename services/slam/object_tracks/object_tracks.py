# SPDX-License-Identifier: Apache-2.0
"""The objects of a map over time."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from schemas.records.mapped_objects import MappedObject
from schemas.records.objects import MotionState, Objects, ObjectTrack
from services.slam.object_tracks.motion_filter import MotionFilter
from services.slam.object_tracks.sighting import CameraView, Outline, Sighting, outline_by_depth, sight
from services.slam.object_tracks.size_priors import Size, usual_size, wheel_inset_m

Array = npt.NDArray[np.float64]

_FORGOTTEN_AFTER_S = 2.0
_SPEED_SIGMA_M_S = 8.0
_ACCELERATION_M_S2 = {"person": 1.0}
_USUAL_ACCELERATION_M_S2 = 2.0
_STANDING_SIGMA_M_S = 0.1
_HEADING_FROM_M_S = 1.0
"""Slower than this a velocity's direction is noise."""
_STANDING = (MotionState.STATIC, MotionState.NON_MOVING)
_SIZE_GAIN = 0.05
_SIZE_TOLERANCE = 0.3


@dataclass
class _Track:
    filter: MotionFilter
    seen_ns: int
    size: Size
    height: float
    """of the footprint in the map, metres"""
    heading_rad: float | None = None


class ObjectTracks:
    """Follows each object by its id. One map at a time, in metres."""

    def __init__(self) -> None:
        self._tracks: dict[int, _Track] = {}

    def forget(self) -> None:
        """What comes next is in another map, or in other units."""
        self._tracks.clear()

    def update(
        self,
        objects: Objects,
        view: CameraView,
        contacts: dict[int, Array],
        depth_m: npt.NDArray[np.float32] | None = None,
    ) -> tuple[MappedObject, ...]:
        """The objects seen in this frame, by id.

        Args:
            objects: with masks that were measured in this frame.
            view: of this frame.
            contacts: object id -> left end, nearest point and right end (3, 3) on the road, camera frame, metres.
            depth_m: (H, W) of this frame; goes before the contacts.
        """
        mapped = []
        for row in sorted(objects.objects, key=lambda row: row.object_id):
            contact = contacts.get(row.object_id)
            outline = None if contact is None else Outline(contact, by_depth=False)
            if depth_m is not None:
                outline = outline_by_depth(objects.track_image == row.object_id, depth_m, view)
            if outline is not None:
                mapped.append(self._follow(row, outline, view, objects.timestamp_ns))
        since_ns = objects.timestamp_ns - int(_FORGOTTEN_AFTER_S * 1e9)
        self._tracks = {number: track for number, track in self._tracks.items() if track.seen_ns >= since_ns}
        return tuple(mapped)

    def _follow(self, row: ObjectTrack, outline: Outline, view: CameraView, timestamp_ns: int) -> MappedObject:
        stands = row.motion_state in _STANDING
        track = self._tracks.get(row.object_id)
        size = usual_size(row.category) if track is None else track.size
        heading_rad = None if track is None else track.heading_rad
        seen = sight(outline, view, size, heading_rad, wheel_inset_m(row.category, size))
        if track is None:
            first = MotionFilter(seen.center[:2], seen.covariance, _SPEED_SIGMA_M_S)
            track = _Track(first, timestamp_ns, size, float(seen.center[2]))
            self._tracks[row.object_id] = track
        else:
            acceleration = _ACCELERATION_M_S2.get(row.category, _USUAL_ACCELERATION_M_S2)
            seconds = (timestamp_ns - track.seen_ns) * 1e-9
            track.filter.predict(seconds, _STANDING_SIGMA_M_S if stands else acceleration)
            track.filter.see(seen.center[:2], seen.covariance)
            track.height += 0.3 * (float(seen.center[2]) - track.height)
            track.seen_ns = timestamp_ns
        if stands:
            track.filter.stand(_STANDING_SIGMA_M_S)
        track.heading_rad = _heading(track, seen)
        track.size = _refined(track, row, seen, view)
        x, y = track.filter.position.tolist()
        vx, vy = track.filter.velocity.tolist()
        return MappedObject(
            object_id=row.object_id,
            category=row.category,
            motion_state=row.motion_state,
            position=(x, y, track.height + track.size.height / 2),
            velocity=(vx, vy, 0.0),
            heading_rad=0.0 if track.heading_rad is None else track.heading_rad,
            size=(track.size.length, track.size.width, track.size.height),
            position_sigma=track.filter.position_sigma,
            velocity_sigma=track.filter.velocity_sigma,
            by_depth=outline.by_depth,
        )


def _heading(track: _Track, seen: Sighting) -> float | None:
    velocity = track.filter.velocity
    speed = float(np.linalg.norm(velocity))
    if speed > max(_HEADING_FROM_M_S, 2 * track.filter.velocity_sigma):
        return math.atan2(velocity[1], velocity[0])
    if track.heading_rad is not None:
        return track.heading_rad
    return seen.side_heading_rad


def _refined(track: _Track, row: ObjectTrack, seen: Sighting, view: CameraView) -> Size:
    """The size with its height by the box in the image, as far as an object of its category may differ."""
    usual = usual_size(row.category)
    height = row.box_px[3] / view.focal_px * seen.near_m
    height = min(max(height, usual.height * (1 - _SIZE_TOLERANCE)), usual.height * (1 + _SIZE_TOLERANCE))
    return track.size._replace(height=track.size.height + _SIZE_GAIN * (height - track.size.height))
