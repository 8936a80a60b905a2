# SPDX-License-Identifier: Apache-2.0
"""Which samples make a batch, and in what size."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

_ALIKE = 0.1
"""of aspects: what their logarithms may differ by"""


class SampleOrder:
    """Every epoch in another order, each sample once in it; the images of a batch have about the same aspect.

    A network that is shown whole images of a drive in a size of another aspect would see little but black borders.

    Args:
        aspects: (N,) width by height of each sample.
        sizes: (width, height), several of one aspect if wanted: each batch has one of those most like its images.
        batch: samples a batch.
        seed: of the order.
    """

    def __init__(
        self, aspects: npt.NDArray[np.float64], sizes: Sequence[tuple[int, int]], batch: int, seed: int
    ) -> None:
        self._batch, self._seed = batch, seed
        of_sizes = np.log([width / height for width, height in sizes])
        alike = np.abs(of_sizes[:, None] - of_sizes) <= _ALIKE
        # sizes of about one aspect are one choice
        nearest = alike.argmax(1)[np.abs(np.log(aspects)[:, None] - of_sizes).argmin(1)]
        self._samples_of = {int(size): np.flatnonzero(nearest == size) for size in np.unique(nearest)}
        self._sizes_of = {
            size: [sizes[int(other)] for other in np.flatnonzero(alike[size])] for size in self._samples_of
        }
        self._batches_an_epoch = sum(-(-len(samples) // batch) for samples in self._samples_of.values())
        # kept, since of a large data set it takes milliseconds to draw; plain, so that workers can be sent it
        self._epoch = -1
        self._order: list[tuple[int, npt.NDArray[np.int64]]] = []

    def batch(self, step: int) -> tuple[list[int], tuple[int, int]]:
        """Numbers of the samples, and (width, height), of a step's batch."""
        epoch, place = divmod(step, self._batches_an_epoch)
        if epoch != self._epoch:
            self._epoch, self._order = epoch, self._drawn(epoch)
        size, numbers = self._order[place]
        fitting = self._sizes_of[size]
        chosen = int(np.random.default_rng((self._seed, step)).integers(len(fitting)))
        return numbers.tolist(), fitting[chosen]

    def _drawn(self, epoch: int) -> list[tuple[int, npt.NDArray[np.int64]]]:
        random = np.random.default_rng((self._seed, epoch))
        found = []
        for size, samples in self._samples_of.items():
            # the last batch is filled up with samples that were in an earlier one
            count = -(-len(samples) // self._batch)
            order = np.resize(random.permutation(samples), count * self._batch)
            found += [(size, numbers) for numbers in order.reshape(count, self._batch)]
        return [found[place] for place in random.permutation(len(found))]
