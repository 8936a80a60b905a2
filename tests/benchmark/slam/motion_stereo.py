# SPDX-License-Identifier: Apache-2.0
"""Depth images out of one moving camera whose true poses are known, where nothing else tells depths."""

from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]
Array = npt.NDArray[np.float64]

PATCH_PX = 9
AWAY_FRAMES = (-6, -3, 3, 6)
LEAST_AGREEING = 2
"""of the images beside one, those that show a pixel best, so that one may hide it"""
LEAST_CORRELATION = 0.85
LEAST_LEAD = 0.1
"""by which the best depth's correlation exceeds that of every other peak"""
LEAST_DROP = 0.01
"""by which it exceeds its neighbours'; a flat peak tells no depth"""
LEAST_DEVIATION = 4.0
"""of a patch, grey levels"""


class MotionStereo:
    """Plane sweep (Collins, "A space-sweep approach to true multi-image matching", CVPR 1996) over planes parallel to
    the image, correlation of patches normalized for mean and contrast, over poses that are given; shares nothing with
    the engine but the images."""

    def __init__(
        self, images: list[Path], world_from_camera: Array, intrinsics: Array, near_m: float = 4.0, far_m: float = 60.0
    ) -> None:
        self._images = images
        self._poses = world_from_camera
        self._intrinsics = intrinsics
        self._inverse_depths = np.linspace(1 / far_m, 1 / near_m, 160)

    def depth(self, index: int) -> Floats:
        """(height, width) metres along the optical axis of an image; 0 where nothing certain is found."""
        own = self._read(index)
        beside = [index + away for away in AWAY_FRAMES if 0 <= index + away < len(self._images)]
        if len(beside) < LEAST_AGREEING:
            return np.zeros_like(own)
        others = [(self._read(other), np.linalg.inv(self._poses[other]) @ self._poses[index]) for other in beside]
        mean, deviation = _statistics(own)
        scores = np.stack(
            [self._score(own, mean, deviation, others, inverse_depth) for inverse_depth in self._inverse_depths]
        )
        scores[:, deviation < LEAST_DEVIATION] = -1
        return _peaks(scores, self._inverse_depths)

    def _read(self, index: int) -> Floats:
        return np.asarray(cv2.imread(str(self._images[index]), cv2.IMREAD_GRAYSCALE), np.float32)

    def _score(
        self, own: Floats, mean: Floats, deviation: Floats, others: list[tuple[Floats, Array]], inverse_depth: float
    ) -> Floats:
        correlations = []
        size = own.shape[1], own.shape[0]
        for image, other_from_own in others:
            plane = other_from_own[:3, :3].copy()
            plane[:, 2] += other_from_own[:3, 3] * inverse_depth
            homography = self._intrinsics @ plane @ np.linalg.inv(self._intrinsics)
            flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
            warped = np.asarray(cv2.warpPerspective(image, homography, size, flags=flags, borderValue=0), np.float32)
            their_mean, their_deviation = _statistics(warped)
            together = cv2.boxFilter(own * warped, -1, (PATCH_PX, PATCH_PX)) - mean * their_mean
            correlations.append(together / np.maximum(deviation * their_deviation, 1.0))
        best = np.sort(np.stack(correlations), axis=0)[-LEAST_AGREEING:]
        return np.asarray(best.mean(axis=0), np.float32)


def _statistics(image: Floats) -> tuple[Floats, Floats]:
    mean = cv2.boxFilter(image, -1, (PATCH_PX, PATCH_PX))
    variance = cv2.boxFilter(image * image, -1, (PATCH_PX, PATCH_PX)) - mean * mean
    return np.asarray(mean, np.float32), np.sqrt(np.maximum(variance, 0)).astype(np.float32)


def _peaks(scores: Floats, inverse_depths: Array) -> Floats:
    best = scores.argmax(axis=0)
    inside = np.clip(best, 1, len(scores) - 2)[None]
    before, at, after = (np.take_along_axis(scores, inside + step, 0)[0] for step in (-1, 0, 1))
    drop = at - 0.5 * (before + after)
    rows = np.arange(len(scores))[:, None, None]
    peaks = np.zeros(scores.shape, bool)
    peaks[1:-1] = (scores[1:-1] >= scores[:-2]) & (scores[1:-1] >= scores[2:])
    second = np.where(peaks & (np.abs(rows - best) > 1), scores, -1).max(axis=0)
    sure = (best == inside[0]) & (at > LEAST_CORRELATION) & (at - second > LEAST_LEAD) & (drop > LEAST_DROP)
    step = inverse_depths[1] - inverse_depths[0]
    inverse_depth = inverse_depths[inside[0]] + step * np.where(
        sure, 0.5 * (after - before) / np.maximum(2 * drop, 1e-6), 0
    )
    return np.where(sure, 1 / inverse_depth, 0).astype(np.float32)
