# SPDX-License-Identifier: Apache-2.0
"""Flow and its error as colours."""

import numpy as np
import numpy.typing as npt

from services.evaluation.optical_flow_error import OUTLIER_PX, OUTLIER_SHARE
from services.formats.kitti_flow import FlowImage

# Baker et al., IJCV 2011: steps from red to yellow, green, cyan, blue, magenta and back, by how well eyes tell them.
_STEPS = (15, 6, 4, 11, 13, 6)
_CORNERS = np.array([(1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1), (1, 0, 1), (1, 0, 0)], dtype=np.float64)

# KITTI's devkit: an error in multiples of the outlier's threshold, from blue (right) to red (wrong), doubling.
_ERROR_EDGES = np.array([0.0, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8, 16])
_ERROR_RGB = np.array([
    (49, 54, 149), (69, 117, 180), (116, 173, 209), (171, 217, 233), (224, 243, 248),
    (254, 224, 144), (253, 174, 97), (244, 109, 67), (215, 48, 39), (165, 0, 38),
], dtype=np.uint8)  # fmt: skip


def colour_wheel() -> npt.NDArray[np.float64]:
    """The 55 colours of directions, (55, 3) red-green-blue in 0..1, from right by way of down, left and up."""
    parts = [
        start + (end - start) * np.arange(count)[:, None] / count
        for start, end, count in zip(_CORNERS[:-1], _CORNERS[1:], _STEPS, strict=True)
    ]
    return np.concatenate(parts)


def colour_flow(image: FlowImage, longest_px: float | None = None) -> npt.NDArray[np.uint8]:
    """Direction as hue, length as saturation up to `longest_px` (default: this image's), (H, W, 3) red-green-blue.

    Unknown pixels are black (Baker et al., IJCV 2011).
    """
    flow = image.flow.astype(np.float64)
    length = np.linalg.norm(flow, axis=2)
    known = length[image.valid]
    longest_px = longest_px or max(float(known.max()) if known.size else 0.0, 1e-9)
    share = length / longest_px
    wheel = colour_wheel()
    place = (np.arctan2(-flow[..., 1], -flow[..., 0]) / np.pi + 1.0) / 2.0 * (len(wheel) - 1)
    before = np.floor(place).astype(np.int64)
    weight = (place - before)[..., None]
    colour = (1.0 - weight) * wheel[before] + weight * wheel[(before + 1) % len(wheel)]
    within = (share <= 1.0)[..., None]
    colour = np.where(within, 1.0 - share[..., None] * (1.0 - colour), 0.75 * colour)
    colour[~image.valid] = 0.0
    return np.floor(255.0 * colour).astype(np.uint8)


def colour_error(error_px: npt.NDArray[np.float32], truth: FlowImage) -> npt.NDArray[np.uint8]:
    """KITTI's error colours, (H, W, 3): blue is right, red an outlier of Fl, unknown black."""
    length = np.linalg.norm(truth.flow, axis=2)
    multiple = np.minimum(error_px / OUTLIER_PX, error_px / np.maximum(OUTLIER_SHARE * length, 1e-9))
    place = np.searchsorted(_ERROR_EDGES, np.nan_to_num(multiple), side="right") - 1
    colour: npt.NDArray[np.uint8] = _ERROR_RGB[place.clip(0, len(_ERROR_RGB) - 1)]
    colour[np.isnan(error_px)] = 0
    return colour
