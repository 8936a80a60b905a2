# SPDX-License-Identifier: Apache-2.0
"""The fastest way to run a network on this machine: measured once, then remembered in the cache."""

import json
import time
from collections.abc import Mapping
from contextlib import suppress
from typing import Final, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from services.segmenter.weights.cache_folder import cache_folder

_RUNS: Final = 3
_WORTH: Final = 1.2
"""times faster than the exact way that another must be to be taken"""
_FILE_NAME: Final = "fastest.json"


Way = TypeVar("Way", bound=str)


class _Inference(Protocol):
    def segment(self, image: npt.NDArray[np.uint8], /) -> object: ...


def fastest(key: str, ways: Mapping[Way, _Inference], box: tuple[int, int]) -> Way:
    """The name of the fastest of `ways`, of which the first is the exact one.

    Args:
        key: all that the times depend on: network, size, processor, threads, versions. What was measured under it
            before is taken, so that a later run computes the same way.
        ways: the runs to choose from, by name.
        box: (width, height) of the image to measure with.
    """
    names = list(ways)
    known = _read().get(key)
    if isinstance(known, dict) and all(type(known.get(name)) is float for name in names):
        took_ms = {name: float(known[name]) for name in names}
    else:
        took_ms = {name: _milliseconds(way, box) for name, way in ways.items()}
        _write(key, {str(name): ms for name, ms in took_ms.items()})
    best = min(names, key=took_ms.__getitem__)
    return best if took_ms[names[0]] > _WORTH * took_ms[best] else names[0]


def _milliseconds(way: _Inference, box: tuple[int, int]) -> float:
    image = np.full((box[1], box[0], 3), 114, np.uint8)
    way.segment(image)
    times = []
    for _ in range(_RUNS):
        begun = time.perf_counter()
        way.segment(image)
        times.append(time.perf_counter() - begun)
    return round(1e3 * min(times), 1)


def _read() -> dict[str, object]:
    try:
        content = json.loads((cache_folder() / _FILE_NAME).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


def _write(key: str, took_ms: Mapping[str, float]) -> None:
    path = cache_folder() / _FILE_NAME
    # where nothing can be kept, the next start measures again
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        part = path.with_name(f"{_FILE_NAME}.part")
        part.write_text(json.dumps({**_read(), key: dict(took_ms)}, indent=1), encoding="utf-8")
        part.replace(path)
