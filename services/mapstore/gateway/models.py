# SPDX-License-Identifier: Apache-2.0
"""The gateway's answers. Lengths are in metres where `scale` is metric, in map units where it is arbitrary."""

import math
from typing import Any, Literal

from pydantic import BaseModel, Field

from schemas.records import Density
from services.mapstore.map_view import MapView
from services.mapstore.object_summary import ObjectSummary

Scale = Literal["metric", "arbitrary"]


def scale_of(metric_scale: bool) -> Scale:
    """The word for it."""
    return "metric" if metric_scale else "arbitrary"


class ErrorAnswer(BaseModel):
    """What was wrong, in one line: the value, and what was expected."""

    detail: str = Field(examples=["radius=-1: expected a number above 0 and up to 1000"])


class MapMoment(BaseModel):
    """Which moment of which map an answer is of."""

    sequence: int = Field(description="the newest frame in the map, -1: none yet")
    timestamp_ns: int = Field(description="that frame's capture time")
    map_id: int
    scale: Scale = Field(description="arbitrary: lengths are in map units, not in metres")
    tracking: Literal["initializing", "tracking", "lost"]


class DensityAnswer(MapMoment):
    """How much moves around a position."""

    level: Literal["unknown", "low", "high"] = Field(
        description="unknown: nothing was ever observed within the radius, or the position itself is not known"
    )
    moving_points: int
    moving_objects: int
    observed_points: int = Field(description="landmarks of any kind within the radius")
    high_from_points: int = Field(description="moving points from which on the level is high")
    position: tuple[float, float, float] | None = Field(description="map frame; null: the newest frame has no pose")
    radius: float
    radius_unit: Literal["m", "map units"]
    window: float | Literal["all"] = Field(description="seconds before timestamp_ns")
    reason: str = Field("", description="why the position is not known")


class PoseAnswer(MapMoment):
    """Where the robot is: x forward, y left, z up (REP-103)."""

    tracked: bool
    reason: str = Field(description="why there is no pose")
    position: tuple[float, float, float] | None = Field(description="of map_from_base")
    orientation: tuple[float, float, float, float] | None = Field(description="of map_from_base, qx qy qz qw")
    map_from_camera: tuple[float, float, float, float, float, float, float] | None = Field(
        description="tx ty tz qx qy qz qw, camera frame optical: x right, y down, z forward"
    )


class ObjectAnswer(BaseModel):
    """One object of the map."""

    object_id: int
    category: str
    state: str
    landmarks: int
    position: tuple[float, float, float] = Field(description="map frame: of its middle, else of its landmarks")
    velocity: tuple[float, float, float] | None = Field(
        description="metres a second, map frame; this and size only of what the newest frame shows, in a metric map"
    )
    speed: float | None = Field(description="metres a second")
    size: tuple[float, float, float] | None = Field(description="length (along heading), width, height in metres")
    heading: float | None = Field(description="radians about the map's z axis, 0 along its x")
    first_seen_ns: int
    last_seen_ns: int


class ObjectsAnswer(MapMoment):
    """The objects of the current map, by id."""

    objects: list[ObjectAnswer]


class HealthAnswer(BaseModel):
    """Whether the service answers, and from what."""

    status: Literal["ok", "waiting"]
    detail: str
    session: str
    sequence: int
    landmarks: int = Field(description="in all maps of the session, of any kind")
    dense_points: int = Field(description="of the semi-dense map; 0 while slam.semi_dense is off")


def moment(view: MapView) -> dict[str, Any]:
    """The fields of MapMoment."""
    return {
        "sequence": view.sequence,
        "timestamp_ns": view.timestamp_ns,
        "map_id": view.map_id,
        "scale": scale_of(view.metric_scale),
        "tracking": view.state.name.lower(),
    }


def health_answer(view: MapView, waiting_for: str = "") -> HealthAnswer:
    """The view's size as an answer; `waiting_for`: what is missing before there is a map to ask about."""
    return HealthAnswer(
        status="waiting" if waiting_for else "ok",
        detail=waiting_for,
        session=view.session,
        sequence=view.sequence,
        landmarks=int(view.counts_by_state().sum()),
        dense_points=view.dense_points,
    )


def density_answer(view: MapView, density: Density, high_from_points: int) -> DensityAnswer:
    """The record as an answer."""
    known = all(math.isfinite(number) for number in density.position)
    return DensityAnswer(
        **moment(view),
        level=density.level.name.lower(),
        moving_points=density.moving_points,
        moving_objects=density.moving_objects,
        observed_points=density.observed_points,
        high_from_points=high_from_points,
        position=density.position if known else None,
        radius=density.radius,
        radius_unit="m" if density.metric_scale else "map units",
        window="all" if math.isinf(density.window_s) else density.window_s,
        reason="" if known else view.reason or "no pose yet",
    )


def object_answer(summary: ObjectSummary) -> ObjectAnswer:
    """The summary as an answer."""
    cuboid = summary.cuboid
    return ObjectAnswer(
        object_id=summary.object_id,
        category=summary.category,
        state=summary.state.name.lower(),
        landmarks=summary.landmarks,
        position=summary.position,
        velocity=None if cuboid is None else cuboid.velocity,
        speed=None if cuboid is None else math.hypot(*cuboid.velocity),
        size=None if cuboid is None else cuboid.size,
        heading=None if cuboid is None else cuboid.heading_rad,
        first_seen_ns=summary.first_seen_ns,
        last_seen_ns=summary.last_seen_ns,
    )
