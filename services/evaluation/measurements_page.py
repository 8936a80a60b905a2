# SPDX-License-Identifier: Apache-2.0
"""A page of measurements in Markdown: each table stands between two markers of its own, written by what measured it.

`<!-- NAME: begin -->` and `<!-- NAME: end -->` are comments to who reads the page; nothing outside them is touched.
"""

import datetime
import os
import platform
import re
from collections.abc import Sequence
from pathlib import Path

from services.runtime.errors import InputError

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")


def machine() -> str:
    """The processor, its cores and today's date: what every number has to stand beside."""
    model = platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    for line in cpuinfo.read_text(encoding="utf-8").splitlines() if cpuinfo.is_file() else ():
        if line.startswith("model name"):
            model = line.split(":", 1)[1].strip()
            break
    return f"{datetime.date.today().isoformat()}, {len(os.sched_getaffinity(0))} cores of {model}"


def markdown_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table as Markdown writes it; a bar or a line's end inside a cell would end it, and is written as neither."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(_cell(cell) for cell in cells) + " |" for cells in lines)


def check_page(page: Path, name: str) -> None:
    """Raise InputError where `put_table` could not write: asked before hours of measuring, not after."""
    if not _NAME.fullmatch(name):
        raise InputError(f"table {name!r}: expected a name of letters, digits, '-', '_' and '.'")
    _place(_read(page), page, name)


def put_table(page: Path, name: str, command: str, table: str, title: str = "") -> str:
    """Replace what stands between `name`'s markers by the table, what made it, where and when; returns that block.

    Where the page has no such markers, a section of the heading `title` (else `name`) is added at its end. Raises
    InputError for a page that is not there, or has only one of the markers.
    """
    check_page(page, name)
    text = _read(page)
    begin, end = _markers(name)
    block = f"{begin}\n`{command}`\n({machine()})\n\n{table}\n{end}"
    place = _place(text, page, name)
    if place is None:
        text = f"{text.rstrip()}\n\n## {title or name}\n\n{block}\n"
    else:
        text = text[: place[0]] + block + text[place[1] :]
    # Whoever is stopped in the middle leaves the old page, not half of one.
    unfinished = page.with_name(f".{page.name}.{os.getpid()}")
    unfinished.write_text(text, encoding="utf-8")
    unfinished.replace(page)
    return block


def _markers(name: str) -> tuple[str, str]:
    return f"<!-- {name}: begin -->", f"<!-- {name}: end -->"


def _place(text: str, page: Path, name: str) -> tuple[int, int] | None:
    begin, end = _markers(name)
    counts = text.count(begin), text.count(end)
    if counts == (0, 0):
        return None
    first, last = text.find(begin), text.find(end)
    if counts != (1, 1) or last < first:
        raise InputError(f"{page}: expected {begin} and {end} after it, once each, or neither of them")
    return first, last + len(end)


def _read(page: Path) -> str:
    try:
        return page.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{page}: no such page, expected a Markdown file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{page}: not a readable text file ({error.__class__.__name__})") from None


def _cell(text: str) -> str:
    return " ".join(text.replace("|", "/").split())
