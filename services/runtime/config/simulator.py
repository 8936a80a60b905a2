# SPDX-License-Identifier: Apache-2.0
"""The simulated street."""

from pydantic import BaseModel, ConfigDict, Field


class SimulatorConfig(BaseModel):
    """The drive that `input = "simulator"` gives; a test holds fields and defaults against `StreetOptions`."""

    model_config = ConfigDict(extra="forbid")

    seed: int = Field(7, ge=0, description="equal seeds give equal bytes, frame by frame")
    width: int = Field(640, ge=32, description="image width in px")
    height: int = Field(192, ge=32, description="image height in px")
    fx_px: float | None = Field(None, gt=0, description="focal length in px; 80 degrees across when not given")
    frames: int = Field(320, ge=1, description="frames in the drive")
    rate_hz: float = Field(10.0, gt=0, description="frames a second")
    speed_m_s: float = Field(8.0, gt=0, description="the camera's speed in m/s")
    camera_height_m: float = Field(1.65, gt=0, description="height of the camera above the road in m")
    empty_start_m: float = Field(60.0, ge=0, description="nothing moves near the camera on these first metres")
    parked_cars: int = Field(26, ge=0, description="cars that stand all the time")
    oncoming_cars: int = Field(5, ge=0, description="cars that come towards the camera")
    leading_cars: int = Field(1, ge=0, description="cars that drive ahead of the camera")
    crossing_cars: int = Field(2, ge=0, description="cars that cross the road")
    starting_cars: int = Field(3, ge=0, description="parked cars that drive off")
    walking_people: int = Field(14, ge=0, description="people who walk along the road")
    crossing_people: int = Field(3, ge=0, description="people who cross the road")
    standing_people: int = Field(6, ge=0, description="people who stand")
    threads: int = Field(1, ge=0, description="threads that cast rays (0: all cores); the bytes do not depend on it")
