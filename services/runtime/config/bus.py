# SPDX-License-Identifier: Apache-2.0
"""How services find each other."""

from pydantic import BaseModel, ConfigDict, Field


class BusConfig(BaseModel):
    """Local by default: one known address, nothing multicast."""

    model_config = ConfigDict(extra="forbid")

    robot: str = Field("robot", pattern=r"^[A-Za-z0-9_-]+$", description="name in every key: kinemap/<robot>/<topic>")
    entry_point: str = Field("tcp/127.0.0.1:7447", description="where the bus can be entered; `run` takes a free port")
    router: str | None = Field(None, description="zenoh router to go through instead, e.g. tcp/10.0.0.1:7447")
    multicast: bool = Field(False, description="also look for other zenoh nodes by multicast")
    shared_memory: bool = Field(True, description="images between processes of one machine through shared memory")
