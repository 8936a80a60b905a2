# SPDX-License-Identifier: Apache-2.0
"""Where instance masks come from."""

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

from schemas.categories import is_category


class SegmenterConfig(BaseModel):
    """Which pixels are one potentially dynamic object."""

    model_config = ConfigDict(extra="forbid")

    backend: Literal["auto", "masks", "recorded", "solov2", "truth", "none"] = Field(
        "auto",
        description="masks: label images beside the input; recorded: those of the session that is the input; solov2: a "
        "network's; truth: the simulator's; none: every frame is left out; auto: the first of these that there is",
    )
    instances: Path | None = Field(
        None, description="folder of label images and instances.json; <input>/instances when not given"
    )
    weights: str | None = Field(
        None,
        min_length=1,
        description="solov2: a file (.safetensors) or a name of `kinemap weights`; when not given, a public model in "
        "the cache, else what comes with this package",
    )
    device: str = Field("auto", description="solov2: cpu, cuda, or auto: cuda where there is one")
    runtime: Literal["auto", "torch", "openvino", "onnxruntime"] = Field(
        "auto",
        description="solov2: the library that runs it; auto takes, of those that are installed, the fastest that finds "
        "the same, measured once. On a GPU there is torch only",
    )
    precision: Literal["auto", "fp32", "bf16", "fp16"] = Field(
        "auto", description="solov2: auto takes 16 bits where they are faster and find the same, measured once"
    )
    threads: int = Field(1, ge=1, le=256, description="solov2: threads of the network on a CPU")
    every: int | None = Field(
        None,
        ge=1,
        le=1000,
        description="segment every so manieth frame, carry the masks over the others; when not given, every one "
        "(lossless) or as many as there is time for (realtime)",
    )
    min_score: float = Field(0.3, ge=0, le=1, description="instances of a lower score are left out")
    categories: tuple[str, ...] = Field(
        ("person", "bicycle", "car", "motorcycle", "bus", "train", "truck", "dog", "cat"),
        description="what is potentially dynamic, by COCO's names",
    )

    @field_validator("categories")
    @classmethod
    def _are_categories(cls, names: tuple[str, ...]) -> tuple[str, ...]:
        for name in names:
            if not is_category(name):
                raise ValueError(f"{name!r} is none of COCO's 80 categories, expected names such as car or person")
        return names
