# SPDX-License-Identifier: Apache-2.0
"""How the camera's motion and that of instances are measured."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class MotionConfig(BaseModel):
    """Moving or standing still, the camera's motion taken out."""

    model_config = ConfigDict(extra="forbid")

    flow: Literal["dis", "raft"] = Field(
        "dis", description="dense flow: dis, OpenCV's (CPU); raft, a network with public weights (`kinemap weights`)"
    )
    flow_weights: str | None = Field(
        None,
        min_length=1,
        description="raft: a .pth file, or a name of `kinemap weights`; when not given, the fastest that was pulled",
    )
    flow_iterations: int = Field(12, ge=1, le=64, description="raft: corrections of the flow")
    device: str = Field("auto", description="raft: cpu, cuda, or auto: cuda where there is one")
    flow_preset: Literal["ultrafast", "fast", "medium"] = Field("fast", description="OpenCV's presets of DIS flow")
    flow_width_px: int = Field(
        800, ge=64, description="wider images are halved until they are no wider, before flow is computed"
    )
    flow_finest_level: int = Field(1, ge=0, le=4, description="finest level of DIS' pyramid; 0 is the image itself")
    threads: int = Field(1, ge=1, description="threads of OpenCV and torch")
    seed: int = Field(20, ge=0, description="of the essential matrix's random samples")
    standing_parallax_px: float = Field(
        0.35, gt=0, description="background displacement left after rotation below which the camera is said to stand"
    )
    heading_sigma: float = Field(
        0.08,
        gt=0,
        description="rad that the direction of travel may lie off the optical axis where the background does not tell; "
        "large for a camera that does not look ahead",
    )
    contact_error_px: float = Field(0.8, gt=0, description="error of the lower edge of a mask")
    depth_error: float = Field(
        0.06, gt=0, description="error of an object's depth against that of its contact with the ground, as a share"
    )
    expected_speed: float = Field(0.25, gt=0, description="of what moves, in the camera's own speed")
