# SPDX-License-Identifier: Apache-2.0
"""Query parameters as text, and what is wrong with them in one line."""

import math
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from services.runtime.errors import InputError

CURRENT = "current"
ALL = "all"
FARTHEST = 1e6
"""No map reaches farther, in metres or map units."""
LARGEST_RADIUS = 1000.0
LONGEST_WINDOW_S = 1e9
_SHOWN = 60


def parse_pose(text: str) -> npt.NDArray[np.float64] | None:
    """(3,) x, y, z in the map frame; None for `current`."""
    if text == CURRENT:
        return None
    numbers = [_number(part) for part in text.split(",")]
    if len(numbers) != 3 or not all(number is not None and abs(number) <= FARTHEST for number in numbers):
        raise InputError(
            f"pose={_shown(text)}: expected '{CURRENT}' or x,y,z, three numbers from -{FARTHEST:.0f} to {FARTHEST:.0f}"
        )
    return np.array(numbers, dtype=np.float64)


def parse_radius(text: str | None, default: float) -> float:
    """Metres, or map units."""
    if text is None:
        return default
    number = _number(text)
    if number is None or not 0 < number <= LARGEST_RADIUS:
        raise InputError(f"radius={_shown(text)}: expected a number above 0 and up to {LARGEST_RADIUS:.0f}")
    return number


def parse_window(text: str | None, default: float) -> float:
    """Seconds, infinity for `all`."""
    if text is None:
        return default
    if text == ALL:
        return math.inf
    number = _number(text)
    if number is None or not 0 <= number <= LONGEST_WINDOW_S:
        raise InputError(
            f"window={_shown(text)}: expected seconds from 0 to {LONGEST_WINDOW_S:.0f}, or '{ALL}' for ever"
        )
    return number


def parse_format(text: str, known: Iterable[str]) -> str:
    """One of `known`."""
    if text not in (names := tuple(known)):
        raise InputError(f"format={_shown(text)}: expected {' or '.join(names)}")
    return text


def check_names(given: Iterable[str], known: Iterable[str]) -> None:
    """A mistyped parameter is refused: with its default instead, the answer would be to another question."""
    names, allowed = list(given), tuple(known)
    for name in names:
        if name not in allowed:
            expected = f"expected {', '.join(allowed)}" if allowed else "expected no parameters"
            raise InputError(f"parameter {_shown(name)}: {expected}")
        if names.count(name) > 1:
            raise InputError(f"parameter {_shown(name)}: given {names.count(name)} times, expected once")


def _number(text: str) -> float | None:
    """A finite number in plain notation."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) and "_" not in text else None


def _shown(text: str) -> str:
    """The value on one line, cut where it is long."""
    plain = "".join(character if character.isprintable() else "\N{REPLACEMENT CHARACTER}" for character in text)
    return plain if len(plain) <= _SHOWN else plain[:_SHOWN] + "..."
