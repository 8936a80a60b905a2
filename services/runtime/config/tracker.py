# SPDX-License-Identifier: Apache-2.0
"""How instances become objects that last."""

from pydantic import BaseModel, ConfigDict, Field


class TrackerConfig(BaseModel):
    """The same object over time, and whether it moves."""

    model_config = ConfigDict(extra="forbid")

    lost_frames: int = Field(30, ge=0, description="frames that an object may be out of sight and keep its id")
    least_iou: float = Field(0.15, gt=0, le=1, description="of a predicted mask and the one found")
    largest_distance: float = Field(
        1.0, gt=0, description="between centres, in box sides, where predicted and found masks do not overlap"
    )
    motion_memory: float = Field(
        0.85, ge=0, lt=1, description="share of the log-odds of moving that the next frame still counts"
    )
    decided_log_odds: float = Field(1.5, gt=0, description="at which an object is said to move, or to stand")
