# SPDX-License-Identifier: Apache-2.0
"""How fast is learned when."""

import math


def learning_rate(step: int, steps: int, *, peak: float, warm_up: int) -> float:
    """Rises in a line over `warm_up` steps, then falls as half a cosine to a hundredth of the peak."""
    if step < warm_up:
        return peak * (step + 1) / warm_up
    part = (step - warm_up) / max(1, steps - warm_up)
    return peak * (0.01 + 0.99 * 0.5 * (1 + math.cos(math.pi * min(part, 1.0))))
