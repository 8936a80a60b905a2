# SPDX-License-Identifier: Apache-2.0
"""Where converted weights lie: `kinemap/weights` in the user's cache (XDG base directory specification)."""

import os
from pathlib import Path

MODEL_SUFFIX = ".safetensors"


def cache_folder() -> Path:
    """The folder, which need not be there yet."""
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "kinemap" / "weights"


def cached_model_path(name: str) -> Path:
    """Where the model of this name lies once it is pulled or imported."""
    return cache_folder() / f"{name}{MODEL_SUFFIX}"
