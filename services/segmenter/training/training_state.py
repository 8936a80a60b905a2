# SPDX-License-Identifier: Apache-2.0
"""What an interrupted training goes on from: one file, replaced whole, read as tensors and plain values only."""

from __future__ import annotations

import pickle
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import torch

from services.runtime.errors import InputError, ResourceError


@dataclass(frozen=True)
class TrainingState:
    """After `step` steps."""

    step: int
    settings: dict[str, Any]
    """what must be the same when it goes on"""
    network: dict[str, Any]
    average: dict[str, Any]
    average_updates: int
    optimizer: dict[str, Any]
    scaler: dict[str, Any]
    curves: dict[str, list[list[float]]]

    def save(self, path: Path) -> None:
        """Raises ResourceError when it cannot be written."""
        part = path.with_name(f"{path.name}.part")
        try:
            torch.save({field.name: getattr(self, field.name) for field in fields(self)}, part)
            part.replace(path)
        except (OSError, RuntimeError) as error:
            raise ResourceError(f"{path}: cannot be written ({error})") from error


def load_training_state(path: Path, settings: dict[str, Any]) -> TrainingState:
    """Read a state that was made with the same settings.

    Raises:
        InputError: it is no whole state, or of other settings; names the first that differs.
    """
    try:
        state = TrainingState(**torch.load(path, map_location="cpu", weights_only=True))
    except (pickle.UnpicklingError, RuntimeError, EOFError, OSError, TypeError, ValueError) as error:
        raise InputError(f"{path}: not the whole state of a training ({type(error).__name__})") from error
    for name, value in settings.items():
        if state.settings.get(name) != value:
            raise InputError(
                f"{path}: was trained with {name} {state.settings.get(name)}, expected {value}: "
                "give the same to go on, or another --out to begin anew"
            )
    return state
