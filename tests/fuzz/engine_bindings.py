# SPDX-License-Identifier: Apache-2.0
"""Call the engine's binding with arrays of any type, shape and content, in any order: it may refuse, never crash.

python -m tests.fuzz.engine_bindings [--seconds 3600] [--seed 0]

Each round runs in a process of its own; the seed of a round that dies is printed, and the program ends with 1.
"""

import argparse
import contextlib
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from services.slam import _engine

_REFUSALS = (ValueError, TypeError, RuntimeError, OverflowError)
_DTYPES = ("u1", "i1", "u2", "i4", "u4", "i8", "f4", "f8", "?", "c8", "U3", "O")
_CALLS_A_ROUND = 60


class AnyArgument:
    """Arguments near what is right and far from it."""

    def __init__(self, rng: np.random.Generator, size: tuple[int, int]) -> None:
        self._rng = rng
        self._size = size

    def image(self, dtype: str, texture: bool) -> Any:
        """An array of about the right kind."""
        kind = self._rng.integers(12)
        shape: tuple[int, ...] = self._size
        if kind == 0:
            shape = tuple(int(n) for n in self._rng.integers(0, 70, self._rng.integers(0, 4)))
        if kind == 1:
            dtype = str(self._rng.choice(_DTYPES))
        array = self._content(shape, dtype, texture)
        if kind == 2:
            return array[:, ::2] if array.ndim > 1 else array
        if kind == 3:
            return np.asfortranarray(array)
        if kind == 4:
            return array.tolist()
        if kind == 5:
            return None
        if kind == 6:
            array.flags.writeable = False
        return array

    def column(self, dtype: str, count: int, high: int) -> Any:
        """A column of the object table."""
        kind = self._rng.integers(10)
        if kind == 0:
            count = int(self._rng.integers(0, 5))
        if kind == 1:
            dtype = str(self._rng.choice(_DTYPES))
        return self._rng.integers(0, high, count).astype(dtype)

    def number(self) -> float:
        """A number that somebody might give."""
        values = [0, 1, -1, 2, 8, 64, 100, 500, 1e-9, 1e9, 1e300, -1e300, np.nan, np.inf, -np.inf, 0.5, 3.7]
        return float(self._rng.choice(values))

    def _content(self, shape: tuple[int, ...], dtype: str, texture: bool) -> Any:
        if texture:
            array = self._rng.integers(0, 256, shape) * (self._rng.random() < 0.9)
        else:
            array = self._rng.random(shape) * 20 - 2
            array[self._rng.random(shape) < 0.1] = self._rng.choice([np.nan, np.inf, -np.inf, 0.0, 1e30])
        with np.errstate(all="ignore"):
            return array.astype(dtype)


def _option(options: _engine.EngineOptions, argument: AnyArgument, rng: np.random.Generator) -> None:
    names = [name for name in dir(options) if not name.startswith("_")]
    name = str(rng.choice(names))
    old = getattr(options, name)
    value: Any = argument.number()
    if isinstance(old, (bool, int)) and np.isfinite(value):
        value = type(old)(value)
    elif isinstance(old, np.ndarray):
        value = rng.random((4, 4)) if rng.random() < 0.5 else np.full(rng.integers(0, 5, 2), value)
    with contextlib.suppress(*_REFUSALS):
        setattr(options, name, value)


def _engine_of(rng: np.random.Generator, argument: AnyArgument, size: tuple[int, int]) -> _engine.Engine | None:
    height, width = size
    numbers = [float(width), float(height), width * 0.6, width * 0.6, width / 2, height / 2]
    if rng.random() < 0.2:
        numbers[rng.integers(len(numbers))] = argument.number()
    distortion = [argument.number() for _ in range(rng.integers(0, 7))] if rng.random() < 0.2 else []
    options = _engine.EngineOptions()
    options.features = 300
    for _ in range(rng.integers(0, 3) if rng.random() < 0.3 else 0):
        _option(options, argument, rng)
    # What is asked for may be large, but this machine is not.
    options.features = min(options.features, 3000)
    options.pyramid_levels = min(options.pyramid_levels, 16)
    try:
        return _engine.Engine(_engine.CameraModel(int(numbers[0]), int(numbers[1]), *numbers[2:], distortion), options)
    except _REFUSALS:
        return None


def fuzz_round(seed: int) -> None:
    """One engine and some calls."""
    rng = np.random.default_rng(seed)
    size = (int(rng.integers(40, 200)), int(rng.integers(60, 320)))
    argument = AnyArgument(rng, size)
    engine = _engine_of(rng, argument, size)
    if engine is None:
        return
    background = rng.integers(0, 256, (size[0] + 80, size[1] + 80)).astype(np.uint8)
    now = 0
    for call in range(_CALLS_A_ROUND):
        now += int(rng.choice([1, 100_000_000, 0, -5, 2**40]))
        objects = int(rng.integers(0, 4))
        try:
            which = rng.integers(16)
            if which == 0:
                engine.take_map_update()
            elif which == 1 and rng.random() < 0.2:
                engine.flush()
            elif which == 2:
                engine.begin_frame(now, argument.image("u1", True))
            else:
                if which < 14:  # a camera that moves over a picture, so that a map comes about
                    shift = call // 2 % 70
                    image = background[10 : 10 + size[0], shift : shift + size[1]].copy()
                    depth = argument.image("f4", False) if rng.random() < 0.2 else None
                    engine.begin_frame(now, image, argument.image("u1", True) if rng.random() < 0.1 else None, depth)
                engine.finish_frame(
                    argument.image("u4", True) if rng.random() < 0.3 else None,
                    argument.column("u4", objects, 300),
                    argument.column("i4", objects, 90),
                    argument.column("u1", objects, 6),
                    bool(rng.random() < 0.8),
                )
        except _REFUSALS:
            continue
    engine.take_map_update()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=3600.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", type=int, help="run the round of this seed here")
    arguments = parser.parse_args()
    if arguments.only is not None:
        fuzz_round(arguments.only)
        return 0
    end, seed = time.monotonic() + arguments.seconds, arguments.seed
    batch = 20
    while time.monotonic() < end:
        # One process a batch keeps the start cheap; a batch that dies is gone through one by one.
        rounds = f"for seed in range({seed}, {seed + batch}): fuzz_round(seed)"
        code = f"from tests.fuzz.engine_bindings import fuzz_round\n{rounds}"
        if subprocess.run([sys.executable, "-c", code], cwd=Path(__file__).parents[2], check=False).returncode != 0:
            for one in range(seed, seed + batch):
                command = [sys.executable, "-m", "tests.fuzz.engine_bindings", "--only", str(one)]
                if subprocess.run(command, check=False).returncode != 0:
                    print(f"died: {' '.join(command)}")
            return 1
        seed += batch
    print(f"{seed - arguments.seed} rounds without a crash")
    return 0


if __name__ == "__main__":
    sys.exit(main())
