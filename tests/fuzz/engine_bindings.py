# SPDX-License-Identifier: Apache-2.0
"""Call the engine's binding with arrays of any type, shape and content, in any order: it may refuse, never crash.

python -m tests.fuzz.engine_bindings [--seconds 3600] [--seed 0]

Each round runs in a process of its own; the seed of a round that dies is printed, and the program ends with 1.
"""

import argparse
import contextlib
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from services.slam import _engine
from services.slam.vocabulary import SHIPPED_VOCABULARY

_REFUSALS = (ValueError, TypeError, RuntimeError, OverflowError)
_DTYPES = ("u1", "i1", "u2", "i4", "u4", "i8", "f4", "f8", "?", "c8", "U3", "O")
_CALLS_A_ROUND = 60
_FRAME_NS = 100_000_000


class AnyArgument:
    """Arguments as they should be, or, with the chance `wild`, near that and far from it."""

    def __init__(self, rng: np.random.Generator, size: tuple[int, int], wild: float) -> None:
        self._rng = rng
        self._size = size
        self._wild = wild

    def is_wild(self) -> bool:
        """Whether the next thing is to be odd."""
        return bool(self._rng.random() < self._wild)

    def image(self, sound: npt.NDArray[Any]) -> Any:
        """This image, or something about it."""
        return self._odd_image(sound) if self.is_wild() else sound

    def objects(self) -> tuple[Any, Any, Any, Any]:
        """A track image with up to three objects, and their table."""
        count = int(self._rng.integers(0, 4))
        track_image = np.zeros(self._size, np.uint32)
        ids = self._rng.choice(np.arange(1, 9), count, replace=False).astype(np.uint32)
        for number in ids:
            top, left = self._rng.integers(0, self._size)
            height, width = self._rng.integers(5, 60, 2)
            track_image[top : top + height, left : left + width] = number
        categories = self._rng.integers(0, 90, count).astype(np.int32)
        states = self._rng.integers(1, 4, count).astype(np.uint8)
        image = None if self._rng.random() < 0.3 else self.image(track_image)
        return image, self._column(ids, 300), self._column(categories, 90), self._column(states, 6)

    def number(self) -> float:
        """A number that somebody might give."""
        values = [0, 1, -1, 2, 8, 64, 100, 500, 1e-9, 1e9, 1e300, -1e300, np.nan, np.inf, -np.inf, 0.5, 3.7]
        return float(self._rng.choice(values))

    def step_ns(self) -> int:
        """From one frame to the next."""
        return int(self._rng.choice([1, 0, -5, 2**40, -(2**62)])) if self.is_wild() else _FRAME_NS

    def _column(self, sound: npt.NDArray[Any], high: int) -> Any:
        if not self.is_wild():
            return sound
        count = len(sound) if self._rng.random() < 0.5 else int(self._rng.integers(0, 5))
        dtype = str(self._rng.choice(_DTYPES)) if self._rng.random() < 0.5 else sound.dtype
        return self._rng.integers(0, high, count).astype(dtype)

    def _odd_image(self, sound: npt.NDArray[Any]) -> Any:
        shape = tuple(int(n) for n in self._rng.integers(0, 70, self._rng.integers(0, 4)))
        name = sound.dtype.name
        odd: list[Callable[[], Any]] = [
            lambda: self._content(shape, name),
            lambda: self._content(sound.shape, str(self._rng.choice(_DTYPES))),
            lambda: self._content(sound.shape, name),
            lambda: sound[:, ::2],
            lambda: np.asfortranarray(sound),
            sound.tolist,
            lambda: None,
        ]
        return odd[self._rng.integers(len(odd))]()

    def _content(self, shape: tuple[int, ...], dtype: str) -> Any:
        array = self._rng.random(shape) * 400 - 20
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


def _engine_of(
    rng: np.random.Generator, argument: AnyArgument, size: tuple[int, int], baseline_m: float
) -> _engine.Engine | None:
    height, width = size
    numbers = [float(width), float(height), width * 0.6, width * 0.6, width / 2, height / 2]
    if argument.is_wild():
        numbers[rng.integers(len(numbers))] = argument.number()
    distortion = [argument.number() for _ in range(rng.integers(0, 7))] if argument.is_wild() else []
    options = _engine.EngineOptions()
    options.features = int(rng.choice([300, 1000]))
    options.semi_dense = bool(rng.random() < 0.2)
    options.camera_height_m = float(rng.choice([0.0, 1.65]))
    options.vocabulary_path = str(SHIPPED_VOCABULARY) if rng.random() < 0.5 else ""
    options.new_map_after_lost = int(rng.integers(1, 6))
    for _ in range(rng.integers(0, 3) if argument.is_wild() else 0):
        _option(options, argument, rng)
    # What is asked for may be large, but this machine is not.
    options.features = min(options.features, 3000)
    options.pyramid_levels = min(options.pyramid_levels, 16)
    try:
        camera = _engine.CameraModel(int(numbers[0]), int(numbers[1]), *numbers[2:], distortion, baseline_m)
        return _engine.Engine(camera, options)
    except _REFUSALS:
        return None


class FuzzRound:
    """One engine before a picture that moves past it, some calls, and what came of them."""

    def __init__(self, seed: int) -> None:
        self._rng = rng = np.random.default_rng(seed)
        self._size = (int(rng.integers(60, 200)), int(rng.integers(120, 320)))
        self._argument = AnyArgument(rng, self._size, float(rng.choice([0.0, 0.03, 0.15, 0.5])))
        self._baseline_m = float(rng.choice([0.0, 0.0, 0.5]))
        self._with_depth = rng.random() < 0.5
        self._engine = _engine_of(rng, self._argument, self._size, self._baseline_m)
        noise = rng.integers(0, 256, (self._size[0], self._size[1] + 100)).astype(np.float32)
        smooth = cv2.GaussianBlur(noise, (0, 0), 1.2)
        self._picture = cv2.normalize(smooth, None, 0, 255, cv2.NORM_MINMAX).astype(np.uint8)
        self._depth_m = (4 + rng.random(self._size)).astype(np.float32)
        self._now = 0
        self.tracked = 0
        """frames"""
        self.keyframes = 0

    def run(self) -> None:
        """All calls."""
        if self._engine is None:
            return
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
            file = str(Path(folder) / "maps.kmap")
            for call in range(_CALLS_A_ROUND):
                with contextlib.suppress(*_REFUSALS):
                    self._call(self._engine, call, file)
            self._engine.take_map_update()

    def _call(self, engine: _engine.Engine, call: int, file: str) -> None:
        which = self._rng.random()
        if which < 0.02:
            engine.flush()
        elif which < 0.04:
            engine.settle()
        elif which < 0.06:
            engine.save_maps(file, bool(self._rng.random() < 0.5))
        elif which < 0.09:
            engine.checkpoint(file)
        elif which < 0.11:
            engine.restore(file)
        elif which < 0.13:
            engine.load_maps(file)
        elif which < 0.14:
            engine.resume_maps(file, int(self._whole_number()))
        elif which < 0.5:
            engine.take_map_update()
        if which > 0.15:
            self._frame(engine, call)

    def _whole_number(self) -> float:
        """A finite one."""
        number = self._argument.number()
        return number if np.isfinite(number) and abs(number) < 2**62 else -1

    def _frame(self, engine: _engine.Engine, call: int) -> None:
        self._now += self._argument.step_ns()
        if not (self._argument.is_wild() and self._rng.random() < 0.3):
            shift = 20 + (call * 2) % 60
            right, depth = None, None
            if self._baseline_m > 0:
                right = self._argument.image(self._view(shift + 10))
            elif self._with_depth:
                depth = self._argument.image(self._depth_m)
            engine.begin_frame(self._now, self._argument.image(self._view(shift)), right, depth)
        result = engine.finish_frame(*self._argument.objects(), bool(self._rng.random() < 0.8))
        self.tracked += result.state == 1
        self.keyframes += result.keyframe_inserted

    def _view(self, shift: int) -> npt.NDArray[np.uint8]:
        return np.ascontiguousarray(self._picture[:, shift : shift + self._size[1]])


def fuzz_rounds(first: int, end: int) -> None:
    """Rounds of these seeds; says how far they came."""
    tracked = keyframes = 0
    for seed in range(first, end):
        fuzz_round = FuzzRound(seed)
        fuzz_round.run()
        tracked += fuzz_round.tracked
        keyframes += fuzz_round.keyframes
    print(f"rounds {first} to {end - 1}: {tracked} frames tracked, {keyframes} keyframes", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=3600.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", type=int, help="run the round of this seed here")
    arguments = parser.parse_args()
    if arguments.only is not None:
        fuzz_rounds(arguments.only, arguments.only + 1)
        return 0
    end, seed = time.monotonic() + arguments.seconds, arguments.seed
    batch = 20
    while time.monotonic() < end:
        # One process a batch keeps the start cheap; a batch that dies is gone through one by one.
        code = f"from tests.fuzz.engine_bindings import fuzz_rounds\nfuzz_rounds({seed}, {seed + batch})"
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
