# SPDX-License-Identifier: Apache-2.0
"""Which images of two cameras with clocks of their own belong together."""

from collections.abc import Sequence

import numpy as np

FARTHEST_NS = 20_000_000
"""a depth image belongs to a colour image at most this far away in time"""


def nearest_pairs(times_ns: Sequence[int], others_ns: Sequence[int], farthest_ns: int) -> list[tuple[int, int]]:
    """Indices into both, the nearest pairs chosen first and each index once, in the order of the first.

    Both increase. As the TUM RGB-D benchmark's associate.py does it; a tie goes to the earlier image.
    """
    sought = np.asarray(times_ns, dtype=np.int64)
    others = np.asarray(others_ns, dtype=np.int64)
    first = np.searchsorted(others, sought - farthest_ns, side="left").tolist()
    last = np.searchsorted(others, sought + farthest_ns, side="right").tolist()
    candidates = [
        (abs(int(others[other] - sought[index])), index, other)
        for index in range(len(sought))
        for other in range(first[index], last[index])
    ]
    partner: dict[int, int] = {}
    taken: set[int] = set()
    for _, index, other in sorted(candidates):
        if index not in partner and other not in taken:
            partner[index] = other
            taken.add(other)
    return sorted(partner.items())
