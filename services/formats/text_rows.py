# SPDX-License-Identifier: Apache-2.0
"""Text files of one record a line: their fields, each with the place to name when it is wrong."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from services.runtime.errors import InputError

_LARGEST_WHOLE = 2**63 - 1
"""Ids are counted in 64 bits."""
_LONGEST_SHOWN = 40


@dataclass(frozen=True)
class TextRow:
    """One line's fields and where it stands."""

    path: Path
    line: int
    fields: tuple[str, ...]

    def whole(self, index: int, name: str, lowest: int | None = None) -> int:
        """Field `index` as a whole number, at least `lowest`; raises InputError naming file, line, field and value."""
        text = self.fields[index]
        expected = "a whole number" if lowest is None else f"a whole number of at least {lowest}"
        try:
            value = int(_without_underscore(text))
        except ValueError:
            raise self.error(name, text, expected) from None
        if lowest is not None and value < lowest:
            raise self.error(name, text, expected)
        if abs(value) > _LARGEST_WHOLE:
            raise self.error(name, text, f"{expected} of 64 bits")
        return value

    def real(self, index: int, name: str) -> float:
        """Field `index` as a finite number; raises InputError naming file, line, field and value."""
        text = self.fields[index]
        try:
            value = float(_without_underscore(text))
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise self.error(name, text, "a finite number")
        return value

    def error(self, name: str, found: str, expected: str) -> InputError:
        """What to raise about one field."""
        shown = found if len(found) <= _LONGEST_SHOWN else f"{found[:_LONGEST_SHOWN]}..."
        return InputError(f"{self.path}:{self.line}: {name} '{shown}', expected {expected}")


def _without_underscore(text: str) -> str:
    """Python takes 1_000 for a number, no other reader of these files does. Raises ValueError for such a text."""
    if "_" in text:
        raise ValueError(text)
    return text


def read_rows(path: Path, expected: str, delimiter: str | None = None) -> Iterator[TextRow]:
    """The lines that are not empty, split at white space or at `delimiter`; a byte order mark is passed over.

    Raises:
        InputError: no such file, or no text; says what was `expected` in it.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"{path}: no such file, expected {expected}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not a readable text file ({type(error).__name__}), expected {expected}") from None
    for number, line in enumerate(text.splitlines(), start=1):
        if line.strip():
            fields = line.split() if delimiter is None else [field.strip() for field in line.split(delimiter)]
            yield TextRow(path, number, tuple(fields))
