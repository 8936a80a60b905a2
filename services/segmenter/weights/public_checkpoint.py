# SPDX-License-Identifier: Apache-2.0
"""Reads mmdetection's SOLOv2 checkpoints: by their own names, and never by running what is in them."""

from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from schemas.categories import CATEGORY_NAMES
from services.runtime.errors import InputError
from services.segmenter.networks import NAMES, build, input_box
from services.segmenter.weights.model_file import ModelDescription
from services.weights.torch_file import load_torch_file

_CATEGORY_WEIGHTS = ("mask_head.conv_cls.weight", "roi_head.mask_head.conv_logits.weight")
"""of SOLOv2 and of Mask R-CNN: one row a category"""


def read_checkpoint(path: Path, sha256: str) -> tuple[ModelDescription, dict[str, Tensor]]:
    """What a checkpoint is, told by the shapes of its tensors, and the tensors.

    Raises:
        InputError: it is no checkpoint, holds more than tensors and plain values, or is of no variant known here.
    """
    content = load_torch_file(path, "a checkpoint of mmdetection's SOLOv2")
    state = content.get("state_dict", content) if isinstance(content, dict) else None
    if not isinstance(state, dict) or not all(isinstance(value, Tensor) for value in state.values()):
        raise InputError(f"{path}: holds no state_dict of tensors, expected a checkpoint of mmdetection's SOLOv2")
    weight = next((name for name in _CATEGORY_WEIGHTS if name in state), None)
    if weight is None:
        raise InputError(f"{path}: has no {_CATEGORY_WEIGHTS[0]}, expected a checkpoint of mmdetection's SOLOv2")
    categories = int(state[weight].shape[0])
    variant = _variant_of(path, state, categories)
    names = _category_names(path, content, categories)
    return ModelDescription(variant, names, input_box(variant), path.name, sha256), dict(state)


def _variant_of(path: Path, state: dict[str, Tensor], categories: int) -> str:
    if any("conv_offset" in name for name in state):
        raise InputError(f"{path}: has deformable convolutions, expected one of {', '.join(NAMES)}")
    shapes = {name: tuple(value.shape) for name, value in state.items()}
    for name in NAMES:
        with torch.device("meta"):
            network = build(name, categories)
        if shapes == {key: tuple(value.shape) for key, value in network.state_dict().items()}:
            return name
    raise InputError(f"{path}: its tensors fit none of {', '.join(NAMES)}")


def _category_names(path: Path, content: Any, count: int) -> tuple[str, ...]:
    """As the checkpoint says (`CLASSES` in mmdetection 2, `dataset_meta` in 3); COCO's where it says nothing."""
    meta = content.get("meta") if isinstance(content, dict) else None
    names: Any = None
    if isinstance(meta, dict):
        dataset = meta.get("dataset_meta")
        names = meta.get("CLASSES") or (
            isinstance(dataset, dict) and (dataset.get("classes") or dataset.get("CLASSES"))
        )
    if not names:
        names = CATEGORY_NAMES
    if len(names) != count:
        raise InputError(f"{path}: {count} categories, expected COCO's {len(CATEGORY_NAMES)} or as many names as that")
    return tuple(map(str, names))
