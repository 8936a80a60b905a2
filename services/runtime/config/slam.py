# SPDX-License-Identifier: Apache-2.0
"""The SLAM engine's options that a user sets."""

from pathlib import Path
from typing import Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator


class SlamConfig(BaseModel):
    """Everything else keeps the engine's defaults."""

    model_config = ConfigDict(extra="forbid")

    stage: Literal["base", "dynamic", "moving"] = Field(
        "moving",
        description="what stays out of tracking: nothing (base), every potentially dynamic object (dynamic), "
        "only what moves (moving)",
    )
    features: int = Field(2000, ge=100, le=20000, description="ORB features an image")
    pyramid_levels: int = Field(8, ge=1, le=16, description="levels of the image pyramid")
    pyramid_factor: float = Field(1.2, gt=1.0, le=2.0, description="scale between two levels")
    seed: int = Field(1, ge=0, description="seed of every random sample")
    merge_delay_frames: int = Field(2, ge=1, le=20, description="frames between a keyframe and its bundle adjustment")
    radial_sigma: float = Field(
        0.01, ge=0, description="radial distortion the calibration may have left, found in young maps; 0: it is exact"
    )
    velocity_change: float = Field(
        0.05,
        ge=0,
        le=100,
        description="by how much of its top speed one camera's velocity changes in a second (sigma): what holds the "
        "scale where traffic hides the street; 0: by anything",
    )
    loop_closing: bool = Field(
        True, description="recognise places seen before: take back the drift since, and join maps"
    )
    camera_height_m: float | None = Field(
        None,
        gt=0.0,
        le=100.0,
        description="of the camera above the road: one camera's map becomes metric by it; unknown: its scale stays "
        "arbitrary, unless depth tells",
    )
    new_map_after_lost: int = Field(
        50, ge=1, description="lost frames after which a new map begins; the old one stays in the store"
    )
    semi_dense: bool = Field(
        False, description="also map what has a gradient in the images of keyframes: map_dense.pcd"
    )
    use_stereo: bool = Field(True, description="take the depths of points, and the scale, from the right image if any")
    use_depth: bool = Field(
        True, description="place moving points, and set the scale, by the depth image if there is one"
    )
    map_file: Path | None = Field(None, description="map of an earlier run, in which this one begins")
    save_map: Path | None = Field(None, description="file that gets the whole map at the end")
    localize_only: bool = Field(False, description="only find the camera in map_file, which stays as it is")
    checkpoint_keyframes: int = Field(
        20, ge=0, description="keyframes between two checkpoints, from which a killed service goes on; 0: none"
    )
    exact_checkpoint_keyframes: int = Field(
        200,
        ge=1,
        description="the same in lossless, where the inputs since then are kept too, and done again after a kill",
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.localize_only and self.map_file is None:
            raise ValueError("localize_only (--localize-only) needs a map_file (--map FILE) to find the camera in")
        if self.localize_only and self.save_map is not None:
            raise ValueError("localize_only (--localize-only) changes no map: none for save_map (--save-map)")
        return self
