# SPDX-License-Identifier: Apache-2.0
"""Optical flow as colours: the direction is the hue, the length the saturation.

Source: Baker et al., "A Database and Evaluation Methodology for Optical Flow", IJCV 2011, its colour wheel.
"""

import numpy as np
import numpy.typing as npt

_STEPS = (("r", "y", 15), ("y", "g", 6), ("g", "c", 4), ("c", "b", 11), ("b", "m", 13), ("m", "r", 6))
"""How many hues lie between red, yellow, green, cyan, blue, magenta and red: as many as the eye can tell apart."""
_CORNERS = {"r": (1, 0, 0), "y": (1, 1, 0), "g": (0, 1, 0), "c": (0, 1, 1), "b": (0, 0, 1), "m": (1, 0, 1)}
_BEYOND = 0.75
"""Brightness of a flow that is longer than the longest shown."""


def colour_wheel() -> npt.NDArray[np.float64]:
    """The hues once round, (55, 3) red-green-blue in 0..1, beginning with red."""
    parts = []
    for start, end, count in _STEPS:
        share = np.arange(count)[:, None] / count
        parts.append((1.0 - share) * np.array(_CORNERS[start]) + share * np.array(_CORNERS[end]))
    return np.concatenate(parts)


def flow_colours(
    flow_px: npt.NDArray[np.floating], longest_px: float | None = None, valid: npt.NDArray[np.bool_] | None = None
) -> npt.NDArray[np.uint8]:
    """Picture (H, W, 3) red-green-blue of a flow (H, W, 2), px to the right and down.

    No motion is white, a flow of `longest_px` (None: the longest of the valid ones) has the full hue, a longer one is
    darker: red to the right, yellow down, blue and cyan to the left, magenta and violet up. Black where not `valid`.
    """
    flow = np.asarray(flow_px, dtype=np.float64)
    known: npt.NDArray[np.bool_] = np.asarray(np.isfinite(flow).all(axis=2))
    if valid is not None:
        known = known & valid
    flow = np.where(known[..., None], flow, 0.0)
    length = np.hypot(flow[..., 0], flow[..., 1])
    longest = float(length.max(initial=0.0)) if longest_px is None else longest_px
    length = length / longest if longest > 0.0 else length
    wheel = colour_wheel()
    # Half a turn on, as in the paper's own code: the wheel's red end meets atan2's jump from -pi to pi.
    place = (np.arctan2(-flow[..., 1], -flow[..., 0]) / np.pi + 1.0) / 2.0 * (len(wheel) - 1)
    low = np.floor(place).astype(np.intp)
    share = (place - low)[..., None]
    hue = (1.0 - share) * wheel[low] + share * wheel[(low + 1) % len(wheel)]
    inside = length[..., None] <= 1.0
    picture = np.where(inside, 1.0 - length[..., None] * (1.0 - hue), _BEYOND * hue)
    picture[~known] = 0.0
    return np.rint(picture * 255.0).astype(np.uint8)
