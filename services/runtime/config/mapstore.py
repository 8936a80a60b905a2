# SPDX-License-Identifier: Apache-2.0
"""The mapstore service's options, and its HTTP gateway's."""

import math
from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, model_validator

OPTICAL_TO_REP103 = (0.0, 0.0, 0.0, -0.5, 0.5, -0.5, 0.5)
"""base_from_camera of a camera that looks forward from the base's origin: x right, y down, z forward to x forward, y
left, z up (REP-103)."""

_Coordinate = Annotated[FiniteFloat, Field(ge=-1e6, le=1e6)]


class MapstoreConfig(BaseModel):
    """Options of the mapstore service."""

    model_config = ConfigDict(extra="forbid")

    database: Path | None = Field(None, description="the durable map; left out: map.sqlite in the run's folder")
    density_radius: float = Field(
        10.0, gt=0, le=1000, description="around the pose, in m, or map units where the scale is arbitrary"
    )
    density_window_s: float = Field(30.0, ge=0, description="how long a movement counts, in s; inf: for ever")
    high_density_points: int = Field(10, ge=1, description="moving points that are high density (thesis, algorithm 5)")
    base_from_camera: tuple[
        _Coordinate, _Coordinate, _Coordinate, _Coordinate, _Coordinate, _Coordinate, _Coordinate
    ] = Field(OPTICAL_TO_REP103, description="camera on the robot: tx ty tz (m) qx qy qz qw")
    serve_http: bool = Field(True, description="whether the gateway answers HTTP")
    http_host: str = Field("127.0.0.1", min_length=1, description="address of the gateway; it asks nobody who they are")
    http_port: int = Field(8000, ge=0, le=65535, description="port of the gateway; 0: a free one")
    max_body_bytes: int = Field(1024, ge=0, description="larger request bodies are refused; no request needs one")

    @model_validator(mode="after")
    def _check(self) -> Self:
        length = math.hypot(*self.base_from_camera[3:])
        if abs(length - 1.0) > 1e-3:
            raise ValueError(f"base_from_camera has a quaternion of length {length:.6g}, expected 1")
        return self
