# SPDX-License-Identifier: Apache-2.0
"""The simulator."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class SimulatorConfig(BaseModel):
    """The drive that `input = "simulator"` gives; a test holds fields and defaults against `DriveOptions`."""

    model_config = ConfigDict(extra="forbid")

    world: Literal["street", "town", "corridor"] = Field("street", description="what is driven through")
    seed: int = Field(7, ge=0, description="equal seeds give equal bytes, frame by frame")
    traffic_seed: int | None = Field(None, ge=0, description="the same place with other traffic")
    frames: int = Field(320, ge=1, description="frames in the drive")
    rate_hz: float = Field(10.0, gt=0, description="frames a second")
    speed_m_s: float = Field(0.0, ge=0, description="the camera's speed in m/s; 0: the world's own (8, corridor 1.2)")
    lateral_offset_m: float = Field(0.0, description="the camera's way beside its usual one in m, left positive")
    threads: int = Field(1, ge=0, description="threads that cast rays (0: all cores); the bytes do not depend on it")

    width: int = Field(640, ge=32, description="image width in px")
    height: int = Field(192, ge=32, description="image height in px")
    fx_px: float | None = Field(None, gt=0, description="focal length in px; 80 degrees across when not given")
    camera_height_m: float = Field(1.65, gt=0, description="height of the camera above the ground in m")
    lens: Literal["pinhole", "radial", "fisheye"] = Field("pinhole", description="model of the lens")
    distortion: tuple[float, ...] = Field((), description="radial: k1 k2 p1 p2 k3; fisheye: k1 k2 k3 k4")
    stereo_baseline_m: float = Field(0.0, ge=0, description="a second camera so far to the right in m; 0: none")

    light: Literal["noon", "low_sun", "overcast", "dusk"] = Field("noon", description="where the light comes from")
    shadows: bool = Field(False, description="cast shadows; slower")
    exposure_wobble: float = Field(0.0, ge=0, description="how far the exposure swings, in stops")
    noise: float = Field(0.0, ge=0, description="the sensor's noise, standard deviation in grey levels")
    motion_blur: float = Field(0.0, ge=0, le=1, description="share of the frame's time that the shutter is open")
    pixel_rain: float = Field(0.0, ge=0, le=0.5, description="share of pixels hit by black or white")
    frozen_frames: float = Field(0.0, ge=0, le=0.5, description="share of frames that show the one before again")
    missing_frames: float = Field(0.0, ge=0, le=0.5, description="share of frames that never come")
    blackout_start: int = Field(0, ge=0, description="the first black frame, where there are any")
    blackout_frames: int = Field(0, ge=0, description="black frames in a row")

    loop_m: float = Field(640.0, description="town: length of the loop in m, about")
    start_m: float = Field(0.0, ge=0, description="town: where on the loop the drive begins, in m")
    max_slope: float = Field(0.05, ge=0, description="town: the steepest a street gets, rise over run")
    traffic: float = Field(0.3, ge=0, le=1, description="town, corridor: how much moves; 1: about a third of the image")
    parked: float = Field(0.5, ge=0, le=1, description="town: share of the parking bays that are taken")
    parked_lanes: float = Field(
        0.0, ge=0, le=1, description="town: share of the other lanes that parked vehicles fill; needs traffic 0"
    )

    empty_start_m: float = Field(60.0, ge=0, description="street: nothing moves near the camera on these first metres")
    parked_cars: int = Field(26, ge=0, description="street: cars that stand all the time")
    oncoming_cars: int = Field(5, ge=0, description="street: cars that come towards the camera")
    leading_cars: int = Field(1, ge=0, description="street: cars that drive ahead of the camera")
    crossing_cars: int = Field(2, ge=0, description="street: cars that cross the road")
    starting_cars: int = Field(3, ge=0, description="street: parked cars that drive off")
    walking_people: int = Field(14, ge=0, description="street: people who walk along the road")
    crossing_people: int = Field(3, ge=0, description="street: people who cross the road")
    standing_people: int = Field(6, ge=0, description="street: people who stand")
