# SPDX-License-Identifier: Apache-2.0
"""Pulls and imports models into the cache, converted."""

from dataclasses import replace
from pathlib import Path

from services.runtime.errors import InputError
from services.segmenter.weights.catalogue import PUBLIC_MODELS, PublicModel, sha256_prefix_of
from services.segmenter.weights.model_file import load_network, read_description, save_model
from services.segmenter.weights.public_checkpoint import read_checkpoint
from services.weights.cache_folder import MODEL_SUFFIX, cache_folder, cached_model_path
from services.weights.checksum import require_sha256_prefix
from services.weights.download import Progress, download


def pull(model: PublicModel, progress: Progress | None = None) -> Path:
    """Download, check and convert a public model; the path of what is in the cache then.

    Raises:
        ResourceError, InputError: as download and read_checkpoint.
    """
    target = cached_model_path(model.name)
    checkpoint = cache_folder() / model.file_name
    digest = download(model.url, checkpoint, model.sha256_prefix, progress)
    _convert(checkpoint, digest, target)
    checkpoint.unlink()
    return target


def import_file(path: Path) -> Path:
    """Take a checkpoint or a model file of ours into the cache; the path of what is there then.

    A published file, by its name, must have its checksum and gets its model's name; others keep their own.

    Raises:
        InputError: the file is damaged, cut off or no SOLOv2.
        ResourceError: the cache cannot be written.
    """
    if path.suffix == MODEL_SUFFIX:
        network, description = load_network(path)
        target = cached_model_path(path.stem)
        save_model(target, replace(description, source=description.source or path.name), network.state_dict())
        return target
    if not path.is_file():
        raise InputError(f"{path}: no such file, expected a checkpoint (.pth) or a model ({MODEL_SUFFIX})")
    digest = require_sha256_prefix(path, sha256_prefix_of(path.name) or "")
    named = {model.file_name: model.name for model in PUBLIC_MODELS}
    target = cached_model_path(named.get(path.name, path.stem))
    _convert(path, digest, target)
    return target


def cached_models() -> list[Path]:
    """The models in the cache that can be read, by name."""
    return [path for path in sorted(cache_folder().glob(f"*{MODEL_SUFFIX}")) if _is_readable(path)]


def _is_readable(path: Path) -> bool:
    try:
        read_description(path)
    except InputError:
        return False
    return True


def _convert(checkpoint: Path, digest: str, target: Path) -> None:
    description, state = read_checkpoint(checkpoint, digest)
    save_model(target, description, state)
