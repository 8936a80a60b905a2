# SPDX-License-Identifier: Apache-2.0
"""How services log."""

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class LogConfig(BaseModel):
    """One line an event."""

    model_config = ConfigDict(extra="forbid")

    level: Literal["debug", "info", "warning", "error"] = Field("info", description="the least that is written")
    json_lines: bool = Field(False, description="each line a JSON object")
