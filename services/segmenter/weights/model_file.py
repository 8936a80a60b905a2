# SPDX-License-Identifier: Apache-2.0
"""A model of ours in one safetensors file: tensors, and in its metadata what they are. Nothing in it can run code."""

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor

from services.runtime.errors import InputError, ResourceError
from services.segmenter.networks import NAMES, Network, build
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.variants import VARIANTS

_FORMAT: Final = "kinemap-solov2"
_VERSION: Final = "1"


@dataclass(frozen=True)
class ModelDescription:
    """What a model file says of itself."""

    variant: str
    """of networks.NAMES"""
    categories: tuple[str, ...]
    """names, in the order of the network's outputs"""
    input_box: tuple[int, int]
    """(width, height) that images are fitted into"""
    source: str
    """the checkpoint, or what it was trained on"""
    source_sha256: str = ""


def save_model(path: Path, description: ModelDescription, state: dict[str, Tensor], *, half: bool = False) -> None:
    """Write a model, whole or not at all; `half` stores what has a fraction in 16 bits. Raises ResourceError."""
    metadata = {
        "format": _FORMAT,
        "format_version": _VERSION,
        "variant": description.variant,
        "categories": json.dumps(description.categories),
        "input_box": json.dumps(description.input_box),
        "source": description.source,
        "source_sha256": description.source_sha256,
    }
    tensors = {name: _stored(value, half) for name, value in state.items()}
    part = path.with_name(f"{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        save_file(tensors, part, metadata)
        _make_readable(part)
        part.replace(path)
    except (OSError, SafetensorError) as error:
        raise ResourceError(f"{path}: cannot be written ({error})") from error


def _make_readable(path: Path) -> None:
    """As any new file: safetensors makes its own for the user alone."""
    mask = os.umask(0)
    os.umask(mask)
    path.chmod(0o666 & ~mask)


def _stored(value: Tensor, half: bool) -> Tensor:
    value = value.detach().cpu().contiguous()
    return value.half() if half and value.is_floating_point() else value


def read_description(path: Path) -> ModelDescription:
    """Read only what the file says of itself.

    Raises:
        InputError: it cannot be read, or is no model of ours; names what was found and expected.
    """
    if not path.is_file():
        raise InputError(f"weights {path}: no such file, expected one that `kinemap weights` or `kinemap train` made")
    try:
        with safe_open(path, framework="pt") as file:
            metadata = file.metadata() or {}
    except (SafetensorError, OSError) as error:
        raise InputError(f"weights {path}: not a whole safetensors file ({error})") from error
    found = (metadata.get("format"), metadata.get("format_version"))
    if found != (_FORMAT, _VERSION):
        raise InputError(f"weights {path}: format {found[0]} {found[1]}, expected {_FORMAT} {_VERSION}")
    try:
        description = ModelDescription(
            metadata["variant"],
            tuple(json.loads(metadata["categories"])),
            _size(json.loads(metadata["input_box"])),
            metadata["source"],
            metadata["source_sha256"],
        )
    except (KeyError, ValueError, TypeError) as error:
        raise InputError(f"weights {path}: its metadata lacks or garbles {error}") from error
    if description.variant not in NAMES:
        raise InputError(f"weights {path}: variant {description.variant}, expected one of {', '.join(NAMES)}")
    return description


def _size(values: list[int]) -> tuple[int, int]:
    width, height = values
    return int(width), int(height)


def load_solov2(path: Path) -> tuple[SoloV2, ModelDescription]:
    """As load_network. Raises InputError for another network too."""
    network, description = load_network(path)
    if not isinstance(network, SoloV2):
        raise InputError(f"weights {path}: {description.variant}, expected one of {', '.join(VARIANTS)}")
    return network, description


def load_network(path: Path) -> tuple[Network, ModelDescription]:
    """The network with its weights, in evaluation mode, 32 bits.

    Raises:
        InputError: as read_description; or its tensors are not those of its variant.
    """
    description = read_description(path)
    with safe_open(path, framework="pt") as file:
        state = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 (it is no mapping)
    network = build(description.variant, len(description.categories))
    try:
        network.load_state_dict({name: _restored(value) for name, value in state.items()})
    except RuntimeError as error:
        first = str(error).splitlines()[1].strip() if "\n" in str(error) else str(error)
        raise InputError(f"weights {path}: not those of {description.variant} ({first})") from error
    return network.eval(), description


def _restored(value: Tensor) -> Tensor:
    return value.to(torch.float32) if value.is_floating_point() else value
