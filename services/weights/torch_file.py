# SPDX-License-Identifier: Apache-2.0
"""Reads what torch.save wrote, never by running what is in it."""

import pickle
import zipfile
from pathlib import Path
from typing import Any

import torch

from services.runtime.errors import InputError


def load_torch_file(path: Path, expected: str) -> Any:
    """Its content, on the CPU. `expected`: in words, for the error.

    Raises:
        InputError: there is no such file, it is cut off, or holds more than tensors and plain values.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file, expected {expected}")
    try:
        return torch.load(path, map_location="cpu", weights_only=True)
    except pickle.UnpicklingError as error:
        raise InputError(f"{path}: refused, it holds more than tensors and plain values ({_brief(error)})") from error
    except (RuntimeError, EOFError, OSError, zipfile.BadZipFile, ValueError, KeyError) as error:
        raise InputError(f"{path}: not a whole checkpoint ({_brief(error)})") from error


def _brief(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:160]
