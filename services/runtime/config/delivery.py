# SPDX-License-Identifier: Apache-2.0
"""How frames are delivered."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class DeliveryConfig(BaseModel):
    """`lossless`: nothing is dropped and the same input gives the same bytes. `realtime`: the newest frame wins."""

    model_config = ConfigDict(extra="forbid")

    mode: Literal["lossless", "realtime"] = Field("lossless", description="lossless or realtime")
    window: int = Field(4, ge=1, le=256, description="frames in flight (lossless)")
    resend_after_s: float = Field(2.0, gt=0, description="an unanswered frame is sent again after this (lossless)")
    deadline_s: float = Field(0.1, gt=0, description="how long slam waits for objects before it goes on (realtime)")
    pending_bundles: int = Field(64, ge=2, description="incomplete frames a service holds before the oldest goes")
