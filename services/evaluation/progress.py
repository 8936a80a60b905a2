# SPDX-License-Identifier: Apache-2.0
"""How an evaluation says how far it is, without knowing who shows it."""

from collections.abc import Iterable, Sequence
from typing import Protocol, TypeVar

Item = TypeVar("Item")


class Progress(Protocol):
    """Gives the items on, one after the other, and may show how many are left."""

    def __call__(self, items: Sequence[Item], what: str) -> Iterable[Item]: ...


def silent(items: Sequence[Item], what: str) -> Iterable[Item]:
    """The items as they are; nothing is shown."""
    del what
    return items
