# SPDX-License-Identifier: Apache-2.0
"""Which input is driven, and how it is read."""

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class CameraConfig(BaseModel):
    """An input is a KITTI odometry folder, a folder of images, a video, a recorded session, or the simulator."""

    model_config = ConfigDict(extra="forbid")

    input: str = Field("simulator", min_length=1, description="path of the input, or 'simulator'")
    calibration: Path | None = Field(
        None, description="calibration file of a folder of images or a video; found beside the images when not given"
    )
    kitti_images: Literal["auto", "image_0", "image_2"] = Field(
        "auto", description="left images of a KITTI folder: grey, colour, or colour where there are some (auto)"
    )
    stereo: bool = Field(True, description="publish the right image too where the input has one")
    rate_hz: float | None = Field(
        None, gt=0, le=1000, description="images a second of a folder that tells no times; 10 when not given"
    )
    max_frames: int | None = Field(None, ge=1, description="stop after this many frames; all when not given")
