# SPDX-License-Identifier: Apache-2.0
"""torchvision's names for the same tensors, and files that are no RAFT's."""

from pathlib import Path

import pytest
import torch
from torch import Tensor

from services.motion.flow.raft.checkpoint import read_raft
from services.motion.flow.raft.network import Raft
from services.motion.flow.raft.variants import VARIANTS
from services.runtime.errors import InputError


def _torchvision_name(ours: str) -> str:
    """As torchvision.models.optical_flow builds it: blocks of convolution (0) and normalisation (1)."""
    match ours.split("."):
        case ["fnet" | "cnet" as part, *rest]:
            return {"fnet": "feature_encoder", "cnet": "context_encoder"}[part] + "." + _in_encoder(rest)
        case ["update_block", "encoder", "conv", last]:
            return f"update_block.motion_encoder.conv.0.{last}"
        case ["update_block", "encoder", name, last]:
            kind = {"c": "corr", "f": "flow"}[name[4]]
            return f"update_block.motion_encoder.conv{kind}{name[-1]}.0.{last}"
        case ["update_block", "gru", name, last]:
            return f"update_block.recurrent_block.convgru{name[5:] or '1'}.{name[:5]}.{last}"
        case ["update_block", "mask", place, last]:
            return f"mask_predictor.{'convrelu.0' if place == '0' else 'conv'}.{last}"
    return ours


def _in_encoder(parts: list[str]) -> str:
    match parts:
        case ["conv2", last]:
            return f"conv.{last}"
        case ["conv1" | "norm1" as name, last]:
            return f"convnormrelu.{0 if name == 'conv1' else 1}.{last}"
        case [layer, block, name, last] if name != "downsample":
            return f"{layer}.{block}.convnormrelu{name[-1]}.{0 if name.startswith('conv') else 1}.{last}"
    return ".".join(parts)


def _network(name: str) -> Raft:
    torch.manual_seed(2)
    return Raft(VARIANTS[name]).eval()


def _saved(state: dict[str, Tensor], path: Path) -> Path:
    torch.save(state, path)
    return path


@pytest.mark.parametrize("name", VARIANTS)
def test_both_publishers_names_are_read(name: str, tmp_path: Path) -> None:
    state = _network(name).state_dict()
    theirs = _saved({_torchvision_name(key): value for key, value in state.items()}, tmp_path / "torchvision.pth")
    authors = _saved({f"module.{key}": value for key, value in state.items()}, tmp_path / "authors.pth")
    for path in (theirs, authors):
        read = read_raft(path)
        assert read.variant == VARIANTS[name]
        assert not read.training
        assert all(torch.equal(value, read.state_dict()[key]) for key, value in state.items())


def test_files_that_are_no_rafts_are_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "flow.pth"
    with pytest.raises(InputError, match=r"flow\.pth: no such file, expected the weights of RAFT"):
        read_raft(path)
    state = _network("raft_small").state_dict()
    state.pop("fnet.conv1.bias")
    with pytest.raises(InputError, match=r"flow\.pth: 105 tensors that fit none of raft_small, raft_large"):
        read_raft(_saved(state, path))
    torch.save([1, 2], path)
    with pytest.raises(InputError, match=r"flow\.pth: holds no tensors by name"):
        read_raft(path)
