# SPDX-License-Identifier: Apache-2.0
"""The recorder service's options."""

from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field


class RecorderConfig(BaseModel):
    """Options of the recorder service."""

    model_config = ConfigDict(extra="forbid")

    file: Path = Field(Path("session.mcap"), description="the session's file; a relative path is inside run.out")
    zstd_level: int = Field(1, ge=0, le=19, description="compression of the chunks, 0: none")
    reserve_mb: int = Field(4, ge=0, description="disk space kept so that a full disk does not cost the file its index")
    producers: tuple[str, ...] = Field(
        ("camera", "segmenter", "motion", "tracker", "slam", "mapstore"),
        description="services whose messages make a frame complete; leave out what does not run",
    )
