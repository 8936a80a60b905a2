# SPDX-License-Identifier: Apache-2.0
"""How fast is learned when."""

import math


def learning_rate(step: int, steps: int, *, peak: float, warm_up: int, cool_down: int) -> float:
    """Rises in a line over `warm_up` steps, stays, and over the last `cool_down` falls to a hundredth as half a cosine.

    Before it falls nothing depends on `steps`: a training can be made longer while it runs (Hu et al., COLM 2024).
    """
    rising = min(1.0, (step + 1) / max(1, warm_up))
    part = min(1.0, max(0, step - (steps - cool_down)) / max(1, cool_down))
    return peak * rising * (0.01 + 0.99 * 0.5 * (1 + math.cos(math.pi * part)))
