# SPDX-License-Identifier: Apache-2.0
"""JSON files: read with one clear line when they are none, written with the same bytes every time."""

import json
from pathlib import Path
from typing import Any

from services.runtime.errors import InputError

_LONGEST = 80


def read_json(path: Path, expected: str) -> Any:
    """What `path` holds.

    Raises:
        InputError: no such file, not readable or not JSON; names the file and says what was `expected` in it.
    """
    try:
        return json.loads(path.read_bytes(), object_pairs_hook=_without_twins)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file, expected {expected}") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}), expected {expected}") from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not JSON ({error}), expected {expected}") from None


def write_json(path: Path, value: Any) -> None:
    """Write `value` compactly, in the order it has."""
    path.write_text(json.dumps(value, separators=(",", ":"), allow_nan=False) + "\n", encoding="utf-8")


def _without_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    # json itself takes the last of two and says nothing: a frame's instances would be gone unseen
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"the name {shortened(twice)} stands twice in an object")
    return found


def shortened(value: Any) -> str:
    """A value for an error message: as JSON, cut where it is long."""
    text = json.dumps(value, default=str)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."
