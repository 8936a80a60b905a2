# SPDX-License-Identifier: Apache-2.0
"""Text files of numbers (times, poses), read so that a mistake is named by file and line."""

from collections.abc import Sequence
from decimal import Decimal, InvalidOperation
from itertools import pairwise
from pathlib import Path

import numpy as np

from services.runtime.errors import InputError

NS_PER_S = 1_000_000_000
ASSUMED_RATE_HZ = 10.0
_LATEST_S = 2**63 // NS_PER_S


def read_lines(path: Path) -> list[tuple[int, str]]:
    """The lines that hold something, each with its number from 1; comments (#) and a byte order mark are left out.

    Raises:
        InputError: the file cannot be read, or is not text.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a text file") from error
    lines = ((number, line.strip()) for number, line in enumerate(text.splitlines(), start=1))
    return [(number, line) for number, line in lines if line and not line.startswith("#")]


def parse_numbers(path: Path, line_number: int, text: str, count: int) -> list[float]:
    """Exactly `count` finite numbers of one line.

    Raises:
        InputError: another count, or something that is no finite number; names file, line, found and expected.
    """
    words = text.split()
    if len(words) != count:
        raise InputError(f"{path} line {line_number}: {len(words)} numbers, expected {count}")
    numbers = []
    for word in words:
        try:
            numbers.append(float(word))
        except ValueError as error:
            raise InputError(f"{path} line {line_number}: {word!r} is not a number") from error
        if not np.isfinite(numbers[-1]):
            raise InputError(f"{path} line {line_number}: {word!r}, expected a finite number")
    return numbers


def parse_time_ns(path: Path, line_number: int, text: str, after_ns: int = -1) -> int:
    """A time in seconds in nanoseconds, exact to the decimal, later than `after_ns`.

    Raises:
        InputError: no number, a negative one, or one that is not later.
    """
    try:
        time_s = Decimal(text)
        in_range = 0 <= time_s < _LATEST_S
    except InvalidOperation as error:
        raise InputError(f"{path} line {line_number}: {text!r}, expected one time in seconds") from error
    time_ns = int((time_s * NS_PER_S).to_integral_value()) if in_range else -1
    if time_ns <= after_ns:
        raise InputError(f"{path} line {line_number}: time {text} s, expected times that increase from 0")
    return time_ns


def rows_of_images(images: Sequence[Path], rows: int) -> list[int]:
    """Which row, from 0, of a file with `rows` rows for a whole sequence belongs to each image.

    Where images are missing, the numbers in their names tell: 000007.png has row 7, or row 6 where they count from 1.
    Images without such names, and those that are the sequence's beginning, have the rows in their order.
    """
    in_order = list(range(len(images)))
    if rows <= len(images) or not all(path.stem.isdecimal() for path in images):
        return in_order
    numbers = [int(path.stem) for path in images]
    if numbers in (in_order, [row + 1 for row in in_order]):
        return in_order
    if numbers[-1] < rows:
        return numbers
    return [number - 1 for number in numbers] if numbers[0] >= 1 and numbers[-1] == rows else in_order


def read_times_ns(path: Path, images: Sequence[Path]) -> list[int]:
    """The images' times of a file with one time in seconds a line, in nanoseconds, exact to the decimal.

    Raises:
        InputError: fewer times than images, no number, a negative one, or times that do not increase.
    """
    lines = read_lines(path)
    if len(lines) < len(images):
        raise InputError(f"{path}: {len(lines)} times, expected {len(images)}, one for every image")
    times_ns: list[int] = []
    for row in rows_of_images(images, len(lines)):
        times_ns.append(parse_time_ns(path, *lines[row], times_ns[-1] if times_ns else -1))
    return times_ns


def times_of_folder(folder: Path, images: Sequence[Path], rate_hz: float | None) -> tuple[list[int], float, list[str]]:
    """Times in ns and their rate in Hz by times.txt, else by `rate_hz`, else by an assumed rate; and what was assumed.

    Raises:
        InputError: a times.txt that cannot be used.
    """
    if (folder / "times.txt").is_file():
        times_ns = read_times_ns(folder / "times.txt", images)
        return times_ns, rate_of(times_ns, rate_hz or ASSUMED_RATE_HZ), []
    notes = []
    if rate_hz is None:
        rate_hz = ASSUMED_RATE_HZ
        notes.append(f"no times.txt in {folder.name}: times are assumed at {rate_hz:g} Hz")
    return even_times_ns(range(len(images)), rate_hz), rate_hz, notes


def even_times_ns(numbers: Sequence[int], rate_hz: float) -> list[int]:
    """Times of the frames of these numbers at an even rate, number 0 at 0."""
    return [round(number * NS_PER_S / rate_hz) for number in numbers]


def rate_of(times_ns: list[int], otherwise_hz: float) -> float:
    """The median rate in Hz of increasing times; `otherwise_hz` where there is one frame only."""
    steps_ns = [later - earlier for earlier, later in pairwise(times_ns)]
    return NS_PER_S / float(np.median(steps_ns)) if steps_ns else otherwise_hz
