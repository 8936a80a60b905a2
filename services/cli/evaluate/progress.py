# SPDX-License-Identifier: Apache-2.0
"""Shows how far an evaluation is: a bar on a terminal, nothing in a log."""

from collections.abc import Iterable, Sequence
from typing import TypeVar

from rich.console import Console
from rich.progress import track

Item = TypeVar("Item")


def bar(items: Sequence[Item], what: str) -> Iterable[Item]:
    """The items, a bar on standard error while they are gone through."""
    console = Console(stderr=True)
    return track(items, description=what, console=console, transient=True, disable=not console.is_terminal)
