# SPDX-License-Identifier: Apache-2.0
"""Weights that anyone can draw again from the parameters' names, so that a reference needs no checkpoint."""

import hashlib
from collections.abc import Mapping, Sequence

import numpy as np
import torch
from torch import Tensor


def drawn_weights(shapes: Mapping[str, Sequence[int]], prefix: str = "kinemap-a") -> dict[str, Tensor]:
    """A state of the network: He-normal kernels, normalisations near 1, categories' scores kept low."""
    return {key: _drawn(key, tuple(shape), prefix) for key, shape in shapes.items()}


def _drawn(key: str, shape: tuple[int, ...], prefix: str) -> Tensor:
    if key.endswith("num_batches_tracked"):
        return torch.zeros(shape, dtype=torch.int64)
    seed = int.from_bytes(hashlib.sha256(f"{prefix}:{key}".encode()).digest()[:8], "little")
    normal = np.random.Generator(np.random.PCG64(seed)).standard_normal(shape)
    if len(shape) >= 2:
        values = normal * np.sqrt(2 / np.prod(shape[1:]))
    elif key.endswith("running_var"):
        values = 1 + 0.1 * np.abs(normal)
    elif key.endswith("weight"):
        values = 1 + 0.1 * normal
    else:
        values = 0.1 * normal
    if key.endswith("conv_cls.weight"):
        values = values * 0.6
    if key.endswith("conv_cls.bias"):
        values = values - 3.5
    return torch.from_numpy(values.astype(np.float32))
