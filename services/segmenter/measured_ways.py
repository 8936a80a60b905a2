# SPDX-License-Identifier: Apache-2.0
"""What was measured of the ways to run a network, and which of them is taken; kept in the cache."""

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from services.weights.cache_folder import cache_folder
from services.weights.checksum import sha256_of

SAME_IOU: Final = 0.98
"""of every mask with the exact way's, where a way finds the same"""
_WORTH: Final = 1.1
"""times faster than the first way that another must be to be taken"""
_FILE_NAME: Final = "fastest.json"


@dataclass(frozen=True)
class MeasuredWay:
    """One way to run a network on this machine. Both None: it does not run here."""

    took_ms: float | None
    least_iou: float | None
    """of the masks it found with those of the exact way; also None where there was nothing to judge by"""

    @property
    def fault(self) -> str:
        """Why it may not be taken instead of the exact way; empty where it may."""
        if self.took_ms is None:
            return "does not run here"
        if self.least_iou is None:
            return "cannot be judged, the network finds nothing in the sample image"
        return "" if self.least_iou >= SAME_IOU else f"finds other masks, IoU {self.least_iou:.3f}"


@dataclass(frozen=True)
class ChosenWay:
    """The way that is taken, and what was measured of it and others. What there was no time to measure is not there."""

    name: str
    measured: dict[str, MeasuredWay]

    def __str__(self) -> str:
        rows = []
        for name, way in self.measured.items():
            took = "" if way.took_ms is None else f" {way.took_ms:.0f} ms"
            rows.append(f"{name}{took}{way.fault and f' (left out: {way.fault})'}")
        return f"{self.name}, of {', '.join(rows)}"


def best_way(measured: Mapping[str, MeasuredWay], asked: Sequence[str]) -> str:
    """The fastest that agrees; the first that is asked for where no other is worth it."""
    usable = {name: measured[name] for name in asked if name in measured and not measured[name].fault}
    took_ms = {name: way.took_ms for name, way in usable.items() if way.took_ms is not None}
    if not took_ms:
        return asked[0]
    best = min(took_ms, key=took_ms.__getitem__)
    first_ms = took_ms.get(asked[0])
    return best if first_ms is None or first_ms > _WORTH * took_ms[best] else asked[0]


def choices_path() -> Path:
    """Where the choices are kept; who removes the file has everything measured again."""
    return cache_folder() / _FILE_NAME


def model_key(path: Path) -> str:
    """What the keys of all that is measured of this model begin with. Raises InputError where it cannot be read."""
    return f"{sha256_of(path)[:12]} "


def remembered(key: str) -> ChosenWay | None:
    """What was chosen under this key; None where it is not as it was written."""
    return _parsed(_read().get(key))


def remembered_of(model: str) -> dict[str, ChosenWay]:
    """All that was chosen for a model, by the rest of the key."""
    known = {key.removeprefix(model): _parsed(entry) for key, entry in _read().items() if key.startswith(model)}
    return {key: choice for key, choice in known.items() if choice is not None}


def remember(key: str, choice: ChosenWay) -> None:
    """Keep it; where nothing can be kept, the next start measures again."""
    path = choices_path()
    rows = {name: {"ms": way.took_ms, "least_iou": way.least_iou} for name, way in choice.measured.items()}
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_name(f"{_FILE_NAME}.part")
        content = {**_read(), key: {"way": choice.name, "measured": rows}}
        part.write_text(json.dumps(content, indent=1), encoding="utf-8")
        part.replace(path)


def _read() -> dict[str, object]:
    try:
        content = json.loads(choices_path().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


def _parsed(entry: object) -> ChosenWay | None:
    match entry:
        case {"way": str(name), "measured": {**rows}}:
            ways = {str(way): _parsed_way(row) for way, row in rows.items()}
            known = {way: measured for way, measured in ways.items() if measured is not None}
            return ChosenWay(name, known) if len(known) == len(ways) else None
    return None


def _parsed_way(row: object) -> MeasuredWay | None:
    match row:
        case {"ms": float() | None as took_ms, "least_iou": float() | None as least_iou}:
            return MeasuredWay(took_ms, least_iou)
    return None
