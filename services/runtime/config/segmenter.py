# SPDX-License-Identifier: Apache-2.0
"""Where instance masks come from."""

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

from schemas.categories import is_category


class SegmenterConfig(BaseModel):
    """Which pixels are one potentially dynamic object."""

    model_config = ConfigDict(extra="forbid")

    backend: Literal["auto", "masks", "recorded", "truth", "none"] = Field(
        "auto",
        description="masks: label images beside the input; recorded: those of the session that is the input; truth: "
        "the simulator's; none: every frame is left out; auto: the first of these that the input has",
    )
    instances: Path | None = Field(
        None, description="folder of label images and instances.json; <input>/instances when not given"
    )
    min_score: float = Field(0.3, ge=0, le=1, description="instances of a lower score are left out")
    categories: tuple[str, ...] = Field(
        ("person", "bicycle", "car", "motorcycle", "bus", "train", "truck"),
        description="what is potentially dynamic, by COCO's names",
    )

    @field_validator("categories")
    @classmethod
    def _are_categories(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        for name in names:
            if not is_category(name):
                raise ValueError(f"{name!r} is none of COCO's 80 categories, expected names such as car or person")
        return names
