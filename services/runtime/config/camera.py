# SPDX-License-Identifier: Apache-2.0
"""Which input is driven, and how it is read."""

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class CameraConfig(BaseModel):
    """An input is a folder or file of a data set, of images or of a recording, a live camera, or the simulator."""

    model_config = ConfigDict(extra="forbid")

    input: str = Field(
        "simulator", min_length=1, description="path of the input, a live camera's address, or 'simulator'"
    )
    calibration: Path | None = Field(
        None,
        description="calibration file of images, a video, a bag or a live camera; beside the input when not given",
    )
    kitti_images: Literal["auto", "image_0", "image_2"] = Field(
        "auto", description="left images of a KITTI folder: grey, colour, or colour where there are some (auto)"
    )
    stereo: bool = Field(True, description="publish the right image too where the input has one")
    rectify: bool = Field(True, description="rectify a stereo pair that is not (EuRoC); without, left images alone")
    depth: bool = Field(True, description="publish depth too where the input has it")
    topic: str | None = Field(None, description="image topic of a bag; the only one there is when not given")
    depth_topic: str | None = Field(
        None, description="depth image topic of a bag; the only one of the images' size and frame when not given"
    )
    info_topic: str | None = Field(
        None, description="camera info or calibration topic of a bag; the image topic's when not given"
    )
    truth_topic: str | None = Field(
        None, description="odometry or pose topic of a bag that tells where the camera really was; none when not given"
    )
    rate_hz: float | None = Field(
        None, gt=0, le=1000, description="images a second of a folder that tells no times; 10 when not given"
    )
    max_frames: int | None = Field(None, ge=1, description="stop after this many frames; all when not given")
