# SPDX-License-Identifier: Apache-2.0
"""Reads mmdetection's SOLOv2 checkpoints: by their own names, and never by running what is in them."""

import pickle
import zipfile
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from schemas.categories import CATEGORY_NAMES
from services.runtime.errors import InputError
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import VARIANTS
from services.segmenter.weights.model_file import ModelDescription

_CATEGORY_WEIGHT = "mask_head.conv_cls.weight"


def read_checkpoint(path: Path, sha256: str) -> tuple[ModelDescription, dict[str, Tensor]]:
    """What a checkpoint is, told by the shapes of its tensors, and the tensors.

    Raises:
        InputError: it is no checkpoint, holds more than tensors and plain values, or is of no variant known here.
    """
    content = _load(path)
    state = content.get("state_dict", content) if isinstance(content, dict) else None
    if not isinstance(state, dict) or not all(isinstance(value, Tensor) for value in state.values()):
        raise InputError(f"{path}: holds no state_dict of tensors, expected a checkpoint of mmdetection's SOLOv2")
    if _CATEGORY_WEIGHT not in state:
        raise InputError(f"{path}: has no {_CATEGORY_WEIGHT}, expected a checkpoint of mmdetection's SOLOv2")
    variant = _variant_of(path, state)
    names = _category_names(path, content, state[_CATEGORY_WEIGHT].shape[0])
    return ModelDescription(variant, names, VARIANTS[variant].test_size, path.name, sha256), dict(state)


def _load(path: Path) -> Any:
    if not path.is_file():
        raise InputError(f"{path}: no such file, expected a checkpoint of mmdetection's SOLOv2")
    try:
        return torch.load(path, map_location="cpu", weights_only=True)
    except pickle.UnpicklingError as error:
        raise InputError(f"{path}: refused, it holds more than tensors and plain values ({_brief(error)})") from error
    except (RuntimeError, EOFError, OSError, zipfile.BadZipFile, ValueError, KeyError) as error:
        raise InputError(f"{path}: not a whole checkpoint ({_brief(error)})") from error


def _brief(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:160]


def _variant_of(path: Path, state: dict[str, Tensor]) -> str:
    if any("conv_offset" in name for name in state):
        raise InputError(f"{path}: has deformable convolutions, expected one of {', '.join(VARIANTS)}")
    shapes = {name: tuple(value.shape) for name, value in state.items()}
    categories = shapes[_CATEGORY_WEIGHT][0]
    for name, variant in VARIANTS.items():
        with torch.device("meta"):
            network = SoloV2(variant, categories)
        if shapes == {key: tuple(value.shape) for key, value in network.state_dict().items()}:
            return name
    raise InputError(f"{path}: its tensors fit none of {', '.join(VARIANTS)}")


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
