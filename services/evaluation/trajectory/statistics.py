# SPDX-License-Identifier: Apache-2.0
"""One kind of error over many poses, in the numbers that papers give."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class ErrorStatistics:
    """Of one error over all poses, in the error's unit. `std` is that of the population (n, not n - 1)."""

    rmse: float
    mean: float
    median: float
    std: float
    min: float
    max: float

    @classmethod
    def of(cls, errors: npt.NDArray[np.float64]) -> "ErrorStatistics":
        """Summarise (N,) errors, N > 0."""
        return cls(
            rmse=float(np.sqrt(np.mean(np.square(errors)))),
            mean=float(errors.mean()),
            median=float(np.median(errors)),
            std=float(errors.std()),
            min=float(errors.min()),
            max=float(errors.max()),
        )
