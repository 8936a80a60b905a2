# SPDX-License-Identifier: Apache-2.0
"""The tracker service's options."""

from pydantic import BaseModel, ConfigDict


class TrackerConfig(BaseModel):
    """Options of the tracker service."""

    model_config = ConfigDict(extra="forbid")
