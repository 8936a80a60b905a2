# SPDX-License-Identifier: Apache-2.0
"""RAFT behind the interface: images of any size, colour or grey; weights by name or file."""

from pathlib import Path

import numpy as np
import pytest
import torch

from services.motion.flow.dense_flow import DenseFlow
from services.motion.flow.options import OpticalFlowOptions
from services.motion.flow.raft.network import Raft
from services.motion.flow.raft.variants import VARIANTS
from services.runtime.errors import InputError


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    folder = tmp_path / "cache" / "kinemap" / "weights"
    folder.mkdir(parents=True)
    return folder


def _save_drawn(path: Path) -> Path:
    torch.manual_seed(3)
    torch.save(Raft(VARIANTS["raft_small"]).state_dict(), path)
    return path


def _options(weights: str | None = None, largest_width_px: int = 800) -> OpticalFlowOptions:
    return OpticalFlowOptions(largest_width_px=largest_width_px, algorithm="raft", weights=weights, iterations=2)


def _pair(shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(4)
    return random.integers(0, 256, shape, np.uint8), random.integers(0, 256, shape, np.uint8)


@pytest.mark.parametrize("shape", [(93, 161, 3), (64, 128), (203, 300, 3)])
def test_every_pixel_has_its_flow(shape: tuple[int, ...], tmp_path: Path) -> None:
    dense = DenseFlow(_options(str(_save_drawn(tmp_path / "mine.pth")), largest_width_px=200))
    current, previous = _pair(shape)
    field = dense.previous_from_current(current, previous)
    assert field.flow.shape == (*shape[:2], 2)
    assert field.miss.shape == field.current.shape == shape[:2]
    assert np.isfinite(field.flow).all()
    again = DenseFlow(_options(str(tmp_path / "mine.pth"), 200)).previous_from_current(current, previous)
    assert field.flow.tobytes() == again.flow.tobytes()


def test_it_is_given_colour_and_dis_is_not(cache: Path) -> None:
    _save_drawn(cache / "raft_small.pth")
    image, _ = _pair((64, 96, 3))
    assert DenseFlow(_options()).kept(image).shape == (64, 96, 3)
    assert DenseFlow().kept(image).shape == (64, 96)


def test_weights_that_are_not_there_are_told_how_to_get() -> None:
    with pytest.raises(InputError, match=r"motion\.flow raft: no weights in .*`kinemap weights pull raft_small`"):
        DenseFlow(_options())
    with pytest.raises(InputError, match=r"motion\.flow_weights raft_large: no such file .*raft_large\.pth"):
        DenseFlow(_options("raft_large"))
    with pytest.raises(InputError, match=r"motion\.flow_weights mine\.pth: no such file"):
        DenseFlow(_options("mine.pth"))
