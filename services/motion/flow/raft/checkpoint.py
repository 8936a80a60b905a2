# SPDX-License-Identifier: Apache-2.0
"""Public checkpoints by their own names: the authors' and torchvision's."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import torch
from torch import Tensor

from services.motion.flow.raft.network import Raft
from services.motion.flow.raft.variants import VARIANTS
from services.runtime.errors import InputError
from services.weights.torch_file import load_torch_file

_WRAPPED: Final = "module."
"""before every name of a network that was trained on several cards"""
_ALIAS: Final = re.compile(r"\.layer\d\.\d\.norm3\.")
"""what the authors' shortcuts are normalised by, which is there under `downsample.1` once more"""
_OF_TORCHVISION: Final = (
    (r"^feature_encoder\.", "fnet."),
    (r"^context_encoder\.", "cnet."),
    (r"net\.convnormrelu\.0\.", "net.conv1."),
    (r"net\.convnormrelu\.1\.", "net.norm1."),
    (r"net\.conv\.", "net.conv2."),
    (r"\.convnormrelu(\d)\.0\.", r".conv\1."),
    (r"\.convnormrelu(\d)\.1\.", r".norm\1."),
    (r"\.motion_encoder\.convcorr(\d)\.0\.", r".encoder.convc\1."),
    (r"\.motion_encoder\.convflow(\d)\.0\.", r".encoder.convf\1."),
    (r"\.motion_encoder\.conv\.0\.", ".encoder.conv."),
    (r"\.recurrent_block\.convgru(\d)\.conv([zrq])\.", r".gru.conv\2\1."),
    (r"^mask_predictor\.convrelu\.0\.", "update_block.mask.0."),
    (r"^mask_predictor\.conv\.", "update_block.mask.2."),
)


def read_raft(path: Path) -> Raft:
    """The network of a .pth file, in evaluation mode.

    Raises:
        InputError: it is no such file, is cut off, holds more than tensors, or is no RAFT.
    """
    content = load_torch_file(path, "the weights of RAFT")
    if not isinstance(content, dict) or not all(isinstance(value, Tensor) for value in content.values()):
        raise InputError(f"{path}: holds no tensors by name, expected the weights of RAFT")
    return raft_of(content, str(path))


def raft_of(state: Mapping[str, Tensor], source: str) -> Raft:
    """The network that a checkpoint's tensors are of, in evaluation mode.

    Raises:
        InputError: they fit neither variant; `source` is named.
    """
    renamed = {_renamed(key): value for key, value in state.items() if not _ALIAS.search(key)}
    shapes = {key: tuple(value.shape) for key, value in renamed.items()}
    for variant in VARIANTS.values():
        with torch.device("meta"):
            network = Raft(variant)
        # the small one has one recurrent unit, which torchvision calls the first of two
        named = renamed if variant.learned_upsampling else _of_one_unit(renamed)
        if {key: tuple(value.shape) for key, value in named.items()} == {
            key: tuple(value.shape) for key, value in network.state_dict().items()
        }:
            network.load_state_dict(named, assign=True)
            return network.eval()
    raise InputError(f"{source}: {len(shapes)} tensors that fit none of {', '.join(VARIANTS)}, expected a RAFT's")


def _renamed(key: str) -> str:
    key = key.removeprefix(_WRAPPED)
    for theirs, ours in _OF_TORCHVISION:
        key = re.sub(theirs, ours, key)
    return key


def _of_one_unit(state: Mapping[str, Tensor]) -> dict[str, Tensor]:
    return {re.sub(r"\.gru\.conv([zrq])1\.", r".gru.conv\1.", key): value for key, value in state.items()}
