# SPDX-License-Identifier: Apache-2.0
"""What belongs to one run."""

from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field


class RunConfig(BaseModel):
    """Where a run writes, and its name."""

    model_config = ConfigDict(extra="forbid")

    out: Path = Field(Path("runs/live"), description="folder for everything the run writes")
    session: str = Field("live", min_length=1, description="the session's id, in every message")
