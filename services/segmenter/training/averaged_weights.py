# SPDX-License-Identifier: Apache-2.0
"""A slow average of the weights, which does better than the last step's (Polyak and Juditsky, 1992)."""

import torch
from torch import Tensor, nn

_DECAY = 0.9995


class AveragedWeights:
    """The exponential average of a network's state; follows faster in the beginning."""

    def __init__(self, network: nn.Module) -> None:
        self._state = {name: value.detach().clone() for name, value in network.state_dict().items()}
        self._updates = 0

    @torch.no_grad()
    def update(self, network: nn.Module) -> None:
        """Take one more step into the average; counters are copied."""
        self._updates += 1
        decay = min(_DECAY, (1 + self._updates) / (10 + self._updates))
        for name, value in network.state_dict().items():
            if value.is_floating_point():
                self._state[name].lerp_(value, 1 - decay)
            else:
                self._state[name].copy_(value)

    def state(self) -> dict[str, Tensor]:
        """The average, by parameter."""
        return self._state

    def restore(self, state: dict[str, Tensor], updates: int) -> None:
        """Go on with an average of before."""
        for name, value in state.items():
            self._state[name].copy_(value)
        self._updates = updates

    @property
    def updates(self) -> int:
        """Steps taken in so far."""
        return self._updates
