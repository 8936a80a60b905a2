# SPDX-License-Identifier: Apache-2.0
"""A graph is compiled for one size of input; a camera has one, a folder of pictures a few."""

from collections import OrderedDict
from collections.abc import Callable
from typing import Final, Generic, TypeVar

Compiled = TypeVar("Compiled")

_MOST: Final = 4


class CompiledSizes(Generic[Compiled]):
    """What `compile_size(height, width)` gave, for the sizes last asked for."""

    def __init__(self, compile_size: Callable[[int, int], Compiled]) -> None:
        self._compile = compile_size
        self._last: OrderedDict[tuple[int, int], Compiled] = OrderedDict()

    def of(self, height: int, width: int) -> Compiled:
        """For inputs of this size; compiled now where it is not there."""
        size = (height, width)
        if size not in self._last:
            if len(self._last) == _MOST:
                self._last.popitem(last=False)
            self._last[size] = self._compile(height, width)
        self._last.move_to_end(size)
        return self._last[size]
