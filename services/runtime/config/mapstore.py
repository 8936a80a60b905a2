# SPDX-License-Identifier: Apache-2.0
"""The mapstore service's options."""

from pydantic import BaseModel, ConfigDict


class MapstoreConfig(BaseModel):
    """Options of the mapstore service."""

    model_config = ConfigDict(extra="forbid")
