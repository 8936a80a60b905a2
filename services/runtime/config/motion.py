# SPDX-License-Identifier: Apache-2.0
"""The motion service's options."""

from pydantic import BaseModel, ConfigDict


class MotionConfig(BaseModel):
    """Options of the motion service."""

    model_config = ConfigDict(extra="forbid")
