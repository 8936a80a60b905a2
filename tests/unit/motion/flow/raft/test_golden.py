# SPDX-License-Identifier: Apache-2.0
"""Agreement with the authors' networks on a pair of real images, weights drawn from the parameters' names."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import cv2
import numpy as np
import pytest
import torch
from torch import Tensor

from services.motion.flow.raft.checkpoint import raft_of
from services.motion.flow.raft.network import RaftFlow
from services.motion.flow.raft.variants import VARIANTS

ITERATIONS = 8
LARGEST_ERROR = 1e-3
"""of the largest flow"""


def _drawn(key: str, shape: Sequence[int]) -> Tensor:
    if key.endswith("num_batches_tracked"):
        return torch.zeros(tuple(shape), dtype=torch.int64)
    seed = int.from_bytes(hashlib.sha256(f"kinemap-a:{key}".encode()).digest()[:8], "little")
    normal = np.random.Generator(np.random.PCG64(seed)).standard_normal(shape)
    if len(shape) >= 2:
        values = normal * np.sqrt(1 / np.prod(shape[1:]))
    elif key.endswith("running_var"):
        values = 1 + 0.1 * np.abs(normal)
    elif key.endswith("weight"):
        values = 1 + 0.1 * normal
    else:
        values = 0.1 * normal
    return torch.from_numpy(values.astype(np.float32))


def _state(shapes: Mapping[str, Sequence[int]]) -> dict[str, Tensor]:
    return {key: _drawn(key, shape) for key, shape in shapes.items()}


def _image(path: Path) -> Tensor:
    pixels = cv2.resize(cv2.imread(str(path)), (616, 184), interpolation=cv2.INTER_LINEAR)
    return torch.from_numpy(np.ascontiguousarray(pixels[..., ::-1]).transpose(2, 0, 1)[None].astype(np.float32))


@pytest.fixture(scope="module", params=VARIANTS)
def both(
    request: pytest.FixtureRequest, golden_outputs: Path, shared_data: Path
) -> tuple[RaftFlow, dict[str, np.ndarray]]:
    """What is computed here, and the reference."""
    folder, pair = golden_outputs / request.param, shared_data / "kitti_flow"
    network = raft_of(_state(json.loads((folder / "keys.json").read_text())), request.param)
    with torch.inference_mode():
        flow = network(_image(pair / "frame1.png"), _image(pair / "frame2.png"), ITERATIONS)
    return flow, dict(np.load(folder / "golden.npz"))


def test_the_flow_agrees(both: tuple[RaftFlow, dict[str, np.ndarray]]) -> None:
    found, golden = both
    for ours, theirs in ((found.coarse, golden["flow_low"]), (found.flow, golden["flow"])):
        assert ours.shape == theirs.shape
        error = np.abs(ours.numpy() - theirs.astype(np.float32)).max()
        assert error < LARGEST_ERROR * np.abs(theirs).max()
