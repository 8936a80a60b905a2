# SPDX-License-Identifier: Apache-2.0
"""What `kinemap simulate` reads out of its flags' texts."""

import re

from services.runtime.errors import InputError

_MAX_SEEDS = 1000
_SIZE = re.compile(r"(\d{1,6})x(\d{1,6})")


def parse_seeds(text: str) -> tuple[int, ...]:
    """Seeds out of such as `1,2,5-8`. Raises InputError for what is neither a whole number nor a range of them."""
    seeds: list[int] = []
    for word in text.split(","):
        low, dash, high = word.strip().partition("-")
        last = high if dash else low
        if not (low.isdecimal() and last.isdecimal() and int(low) <= int(last)):
            raise InputError(f"--seeds {text}: expected whole numbers or ranges of them, such as 1,2,5-8")
        if int(last) - int(low) >= _MAX_SEEDS:
            raise InputError(f"--seeds {text}: expected at most {_MAX_SEEDS} seeds")
        seeds.extend(range(int(low), int(last) + 1))
    return tuple(seeds)


def parse_size(text: str) -> tuple[int, int]:
    """Width and height out of such as `1242x375`. Raises InputError for anything else."""
    match = _SIZE.fullmatch(text.strip())
    if match is None:
        raise InputError(f"--size {text}: expected WIDTHxHEIGHT in px, such as 1242x375")
    return int(match[1]), int(match[2])
