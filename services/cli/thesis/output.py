# SPDX-License-Identifier: Apache-2.0
"""How the subcommands of `kinemap thesis` show and keep what they found."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TypeVar

from rich.console import Console
from rich.progress import track

from services.evaluation.run.outcome import Report
from services.runtime.errors import InputError, ResourceError

Item = TypeVar("Item")
Table = tuple[Sequence[str], Sequence[Sequence[str]]]
"""header and rows"""


def out_folder(path: Path) -> Path:
    """Make the folder. Raises InputError where there is a file, ResourceError where it cannot be made."""
    if path.exists() and not path.is_dir():
        raise InputError(f"--out {path}: is a file, expected a folder")
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ResourceError(f"--out {path}: cannot be made ({error.strerror})") from error
    return path


def write_results(folder: Path, name: str, title: str, parts: Sequence[str | Table], values: Report) -> None:
    """Write `name`.md with the parts, tables or paragraphs, and `name`.json with everything measured.

    Raises ResourceError where they cannot be written.
    """
    from services.evaluation.measurements_page import markdown_table
    from services.evaluation.run.report import write_report

    texts = [part if isinstance(part, str) else markdown_table(*part) for part in parts]
    try:
        (folder / f"{name}.md").write_text("\n\n".join([f"# {title}", *texts]) + "\n", encoding="utf-8")
        write_report(values, folder / f"{name}.json")
    except OSError as error:
        raise ResourceError(f"--out {folder}: cannot be written ({error.strerror})") from error


def frame_bar(items: Iterable[Item], total: int, what: str) -> Iterable[Item]:
    """The items, a bar on standard error while they are gone through."""
    console = Console(stderr=True)
    return track(items, what, total=total, console=console, transient=True, disable=not console.is_terminal)


def print_markdown(folder: Path, name: str) -> None:
    """Print what was written, then where."""
    print((folder / f"{name}.md").read_text(encoding="utf-8"))
    print(f"folder {folder}")
