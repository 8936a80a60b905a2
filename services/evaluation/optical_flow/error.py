# SPDX-License-Identifier: Apache-2.0
"""Endpoint error and outliers of optical flow, over a whole data set in bounded memory."""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from services.formats.kitti_flow import FlowImage
from services.runtime.errors import InputError

OUTLIER_PX = 3.0
OUTLIER_SHARE = 0.05
BANDS_PX = {"s0-10": (0.0, 10.0), "s10-40": (10.0, 40.0), "s40+": (40.0, np.inf)}
"""Of the true flow's length, as in Sintel's evaluation (Butler et al., ECCV 2012)."""

BINS_PER_PX = 1024
_LARGEST_PX = 128


@dataclass
class FlowError:
    """Sums over the pixels that count; they add up over images.

    A pixel counts where the truth is known. `epe` is the distance in px between the ends of true and estimated flow
    where there is an estimate; `outliers` (KITTI's Fl) is the share of pixels whose error is above 3 px and above 5 %
    of the true length (Menze and Geiger, CVPR 2015), a pixel without an estimate being one. None without a pixel.
    """

    true_pixels: int = 0
    estimated_pixels: int = 0
    outlier_pixels: int = 0
    error_sum_px: float = 0.0
    band_pixels: dict[str, int] = field(default_factory=lambda: dict.fromkeys(BANDS_PX, 0))
    band_sum_px: dict[str, float] = field(default_factory=lambda: dict.fromkeys(BANDS_PX, 0.0))
    histogram: npt.NDArray[np.int64] = field(
        default_factory=lambda: np.zeros(BINS_PER_PX * _LARGEST_PX + 1, dtype=np.int64)
    )

    @property
    def epe_px(self) -> float | None:
        """Mean endpoint error."""
        return self.error_sum_px / self.estimated_pixels if self.estimated_pixels else None

    @property
    def median_px(self) -> float | None:
        """Median endpoint error, to 1/1024 px; 128 where it is farther."""
        if not self.estimated_pixels:
            return None
        place = np.searchsorted(np.cumsum(self.histogram), (self.estimated_pixels + 1) // 2)
        return min((int(place) + 0.5) / BINS_PER_PX, float(_LARGEST_PX))

    @property
    def outliers(self) -> float | None:
        """Fl, 0..1."""
        return self.outlier_pixels / self.true_pixels if self.true_pixels else None

    @property
    def density(self) -> float | None:
        """Share of the pixels that count where there is an estimate."""
        return self.estimated_pixels / self.true_pixels if self.true_pixels else None

    def band_epe_px(self, band: str) -> float | None:
        """Mean endpoint error of the pixels in one of BANDS_PX."""
        return self.band_sum_px[band] / self.band_pixels[band] if self.band_pixels[band] else None

    def add(self, error_px: npt.NDArray[np.float32], truth: FlowImage, counted: npt.NDArray[np.bool_]) -> None:
        """Add one image's errors (H, W), not a number where there is no estimate, where `counted` (H, W)."""
        error = error_px[counted].astype(np.float64)
        length = np.linalg.norm(truth.flow[counted].astype(np.float64), axis=1)
        estimated = ~np.isnan(error)
        self.true_pixels += error.size
        self.outlier_pixels += int(np.sum(~estimated | ((error > OUTLIER_PX) & (error > OUTLIER_SHARE * length))))
        error, length = error[estimated], length[estimated]
        self.estimated_pixels += error.size
        self.error_sum_px += float(error.sum())
        bins = np.minimum(error * BINS_PER_PX, BINS_PER_PX * _LARGEST_PX).astype(np.int64)
        self.histogram += np.bincount(bins, minlength=self.histogram.size)
        for band, (low, high) in BANDS_PX.items():
            within = (length >= low) & (length < high)
            self.band_pixels[band] += int(within.sum())
            self.band_sum_px[band] += float(error[within].sum())


def endpoint_error(truth: FlowImage, found: FlowImage) -> npt.NDArray[np.float32]:
    """Distance between the ends of both flows, float32 (H, W) px; not a number where either is unknown.

    Raises:
        InputError: images of different sizes.
    """
    if truth.valid.shape != found.valid.shape:
        (height, width), (true_height, true_width) = found.valid.shape, truth.valid.shape
        raise InputError(f"flow of {width}x{height} px, expected {true_width}x{true_height} as in the truth")
    error = np.asarray(np.linalg.norm(truth.flow - found.flow, axis=2), dtype=np.float32)
    error[~(truth.valid & found.valid)] = np.nan
    return error
