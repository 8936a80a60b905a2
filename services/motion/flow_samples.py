# SPDX-License-Identifier: Apache-2.0
"""The flow at a grid of trustworthy pixels: what ego-motion and instance motion are measured on."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from services.motion.flow.dense_flow import FlowField
from services.motion.two_view import FloatArray, PinholeCamera


@dataclass(frozen=True)
class FlowSampling:
    """Which pixels are sampled. Texture is Harris' corner measure: along a mere edge flow slides."""

    background_stride: int = 2
    """background is sampled at every so many-th pixel that instances are sampled at, in either direction"""
    samples_a_row: int = 320
    """that a row of pixels would give where instances cover all of it; at least two pixels lie between two samples"""
    border_px: int = 4
    least_texture: float = 4e-6
    """square root of Harris' measure (k = 0.05, 7 px), of an image scaled to 0..1"""
    largest_miss_px: float = 0.5
    """that the flow there and back may end beside its start, plus `largest_miss_share` of its length"""
    largest_miss_share: float = 0.05
    largest_grey_change: float = 20.0
    """between the (smoothed) pixel and where the flow says it was; above, it was hidden or the flow is wrong"""


@dataclass(frozen=True)
class FlowSamples:
    """N sampled pixels; `current` and `previous` are normalised coordinates (N, 2), `pixel` (N, 2) integer x, y."""

    pixel: npt.NDArray[np.int32]
    current: FloatArray
    previous: FloatArray
    flow_px: FloatArray
    texture: FloatArray
    focal_px: float

    def __len__(self) -> int:
        return len(self.pixel)

    def where(self, chosen: npt.NDArray[np.bool_] | npt.NDArray[np.intp]) -> "FlowSamples":
        """The samples that `chosen` picks, by mask or by index."""
        return FlowSamples(
            self.pixel[chosen],
            self.current[chosen],
            self.previous[chosen],
            self.flow_px[chosen],
            self.texture[chosen],
            self.focal_px,
        )


def sample_flow(
    field: FlowField, labels: npt.NDArray[np.uint32], camera: PinholeCamera, sampling: FlowSampling | None = None
) -> FlowSamples:
    """Sample a flow field where both of its images support it.

    Instances, the non-zero `labels` (H, W), are sampled more finely than the background.
    """
    sampling = sampling or FlowSampling()
    height, width = field.current.shape
    border = sampling.border_px
    stride = max(2, round(width / sampling.samples_a_row))
    grid_y, grid_x = np.mgrid[border : height - border : stride, border : width - border : stride]
    x, y = grid_x.ravel(), grid_y.ravel()

    coarse = np.zeros(grid_x.shape, dtype=bool)
    coarse[:: sampling.background_stride, :: sampling.background_stride] = True
    wanted = coarse.ravel() | (labels[y, x] != 0)

    corner_measure = cv2.cornerHarris(field.current, 7, 3, 0.05)[y, x].astype(np.float64)
    texture = np.sqrt(np.maximum(corner_measure, 0.0))
    shift = field.flow[y, x].astype(np.float64)
    target = np.column_stack((x, y)) + shift
    inside = np.all((target >= border) & (target <= (width - 1 - border, height - 1 - border)), axis=1)
    returns = field.miss[y, x] < sampling.largest_miss_px + sampling.largest_miss_share * np.hypot(
        shift[:, 0], shift[:, 1]
    )

    map_x, map_y = (target[:, axis].astype(np.float32).reshape(grid_x.shape) for axis in (0, 1))
    was = cv2.remap(cv2.blur(field.previous, (5, 5)), map_x, map_y, cv2.INTER_LINEAR).ravel()
    change = np.abs(was.astype(np.float64) - cv2.blur(field.current, (5, 5))[y, x])
    kept = wanted & inside & returns & (texture > sampling.least_texture) & (change < sampling.largest_grey_change)

    pixel = np.column_stack((x, y))[kept].astype(np.int32)
    return FlowSamples(
        pixel=pixel,
        current=camera.normalise(pixel.astype(np.float64)),
        previous=camera.normalise(target[kept]),
        flow_px=shift[kept],
        texture=texture[kept],
        focal_px=camera.focal_px,
    )
