# SPDX-License-Identifier: Apache-2.0
"""Which model runs, and why."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

from services.runtime.errors import InputError
from services.segmenter.solov2.variants import VARIANTS
from services.segmenter.weights.catalogue import PUBLIC_MODELS, public_model
from services.weights.cache_folder import MODEL_SUFFIX, cache_folder, cached_model_path

SHIPPED_WEIGHTS: Final = Path(__file__).parent / f"default{MODEL_SUFFIX}"
"""The weights that come with this package."""


@dataclass(frozen=True)
class ModelChoice:
    """A model file that is there, and in a few words why it is this one."""

    path: Path
    why: str


def choose_model(asked: str | None) -> ModelChoice:
    """The model that is asked for; else a public SOLOv2 out of the cache, the fastest first; else the shipped one.

    Args:
        asked: a file, the name of a model in the cache, or None.

    Raises:
        InputError: it is not there, or there is none at all; says how to get one.
    """
    choice = _asked(asked) if asked is not None else _found()
    if choice is None:
        raise InputError(
            f"no network for the segmenter: none of the public models in {cache_folder()} and no default weights "
            f"in this package, expected one: `kinemap weights pull {PUBLIC_MODELS[0].variant}`, or segmenter.weights"
        )
    return choice


def has_model(asked: str | None) -> bool:
    """Whether there is one to choose; also when one is asked for, which may then turn out to be missing."""
    return asked is not None or _found() is not None


def _asked(asked: str) -> ModelChoice:
    if asked.endswith(MODEL_SUFFIX):
        path = Path(asked)
        if not path.is_file():
            raise InputError(f"weights {path}: no such file, expected one of `kinemap weights` or `kinemap train`")
        return ModelChoice(path, "segmenter.weights names the file")
    path = cached_model_path(asked)
    if not path.is_file():
        # a public model's other names: of its variant, of its checkpoint
        name = public_model(asked).name
        path = cached_model_path(name)
        if not path.is_file():
            raise InputError(f"weights {asked}: not in {cache_folder()}, `kinemap weights pull {name}` gets them")
    return ModelChoice(path, "segmenter.weights names it")


def _found() -> ModelChoice | None:
    for model in PUBLIC_MODELS:
        if model.variant not in VARIANTS:
            continue
        path = cached_model_path(model.name)
        if path.is_file():
            return ModelChoice(path, "a public model in the cache")
    if SHIPPED_WEIGHTS.is_file():
        return ModelChoice(SHIPPED_WEIGHTS, "comes with this package; no public model is in the cache")
    return None
