# SPDX-License-Identifier: Apache-2.0
"""Puts a benchmark's table into docs/measurements.md, between its own two markers, and nowhere else."""

import datetime
import os
import platform
from collections.abc import Sequence
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "measurements.md"


def machine() -> str:
    """The processor, its cores and today's date: what every number has to stand beside."""
    model = platform.machine()
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            model = line.split(":", 1)[1].strip()
            break
    return f"{datetime.date.today().isoformat()}, {len(os.sched_getaffinity(0))} cores of {model}"


def markdown_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table as Markdown writes it."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def put(name: str, command: str, table: str) -> None:
    """Replace what stands between `name`'s markers by the table, what made it, where and when; print it too."""
    begin, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    text = PAGE.read_text(encoding="utf-8")
    if begin not in text or end not in text:
        raise SystemExit(f"{PAGE}: no markers {begin} and {end}")
    block = f"{begin}\n`{command}`\n({machine()})\n\n{table}\n{end}"
    PAGE.write_text(text[: text.index(begin)] + block + text[text.index(end) + len(end) :], encoding="utf-8")
    print(block)
