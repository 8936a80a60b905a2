# SPDX-License-Identifier: Apache-2.0
"""The recorder service's options."""

from pydantic import BaseModel, ConfigDict


class RecorderConfig(BaseModel):
    """Options of the recorder service."""

    model_config = ConfigDict(extra="forbid")
