# SPDX-License-Identifier: Apache-2.0
"""What slam gives of the objects in a frame: where they are in the map."""

from dataclasses import dataclass

from schemas.records.objects import MotionState


@dataclass(frozen=True)
class MappedObject:
    """One object as a cuboid in the map frame; lengths in metres."""

    object_id: int
    category: str
    motion_state: MotionState
    position: tuple[float, float, float]
    """middle of the cuboid"""
    velocity: tuple[float, float, float]
    """metres a second"""
    heading_rad: float
    """about the map's z, 0 along its x; its front cannot be told from its back while the object stands"""
    size: tuple[float, float, float]
    """length (along the heading), width, height"""
    position_sigma: float
    velocity_sigma: float
    """standard deviations, of the worse axis"""
    by_depth: bool = False
    """placed by a depth image; else by where it touches the road"""


@dataclass(frozen=True)
class MappedObjects:
    """The objects that a frame shows, by id; none while the map is not in metres."""

    timestamp_ns: int
    map_id: int = 0
    metric_scale: bool = False
    objects: tuple[MappedObject, ...] = ()
