# SPDX-License-Identifier: Apache-2.0
"""A model file whose weights were drawn, not learned."""

from pathlib import Path

import torch

from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import VARIANTS
from services.segmenter.weights.model_file import ModelDescription, save_model

CATEGORIES = ("person", "car", "chair")
_VARIANT = "solov2-light_r18"


def save_drawn_model(path: Path, categories: tuple[str, ...] = CATEGORIES) -> Path:
    """Write it to `path`, for images of 96x64 px."""
    torch.manual_seed(3)
    state = SoloV2(VARIANTS[_VARIANT], len(categories)).state_dict()
    save_model(path, ModelDescription(_VARIANT, categories, (96, 64), "a test"), state, half=True)
    return path
