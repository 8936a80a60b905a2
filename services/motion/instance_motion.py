# SPDX-License-Identifier: Apache-2.0
"""The probability that an instance moves by itself, the camera's motion taken out."""

from dataclasses import dataclass, field

import cv2
import numpy as np
import numpy.typing as npt

from services.motion.ego_motion import EgoMotionEstimate
from services.motion.flow_samples import FlowSamples
from services.motion.ground_contact import find_contact
from services.motion.ground_plane import GroundPlane
from services.motion.motion_refinement import flow_noise_growth
from services.motion.standing_flow import StandingFlow, StandingFlowOptions, StandingObjects, ViewPair
from services.motion.two_view import FloatArray, Parallax, PinholeCamera, measure_parallax

BoxPx = tuple[int, int, int, int]
"""x, y, width, height"""


@dataclass(frozen=True)
class InstanceMotionOptions:
    """How sure each kind of evidence is."""

    least_samples: int = 5
    few_samples: int = 16
    """at so many samples the flow's noise counts 1.4 times: they lie at edges, or between things that hide the rest"""
    flow_noise: float = 0.9
    """of an instance's median flow, in the noise of one background sample: neighbouring flow vectors err together"""
    least_noise_px: float = 0.1
    direction_error: float = 0.008
    """rad, of the camera's direction of travel: across the epipolar line in shares of the parallax"""
    expected_speed: float = 0.25
    """of what moves, in the camera's own speed"""
    least_expected_px: float = 1.0
    prior_log_odds: float = 0.3
    """that what a segmenter calls potentially dynamic moves, before anything is measured"""
    largest_log_odds: float = 4.0
    lower_share: float = 0.6
    """the share of an instance, from below, whose depth is compared with that of its contact"""
    standing: StandingFlowOptions = field(default_factory=StandingFlowOptions)


@dataclass(frozen=True)
class MotionEvidence:
    """What one image pair says about one instance. Residuals are medians over its samples."""

    moving_probability: float
    epipolar_residual_px: float
    """distance from the epipolar line; without baseline, the displacement left after the camera's rotation"""
    residual_noise_px: float
    samples: int
    along_residual_px: float = 0.0
    """displacement along the epipolar line beyond that of a thing standing on the ground there"""
    along_noise_px: float = np.inf


NO_EVIDENCE = MotionEvidence(0.5, 0.0, 0.0, 0)


class InstanceMotionEstimator:
    """Compares an instance's flow with the flow it would have if it stood where it touches the ground.

    Across the epipolar line the answer needs no depth. Along it (a car ahead, or oncoming, on a straight street) any
    speed looks like some depth (the degenerate case of Yuan et al., PAMI 2007), so the depth is taken from the ground
    under the object: a car ahead at our own speed shows no parallax although near, one pulling away a negative depth,
    an oncoming one is too near for where it stands. Where the contact is hidden only "too far" remains a contradiction.
    """

    def __init__(
        self,
        samples: FlowSamples,
        background: npt.NDArray[np.bool_],
        ego: EgoMotionEstimate,
        *,
        ground: GroundPlane | None,
        camera: PinholeCamera,
        options: InstanceMotionOptions | None = None,
    ) -> None:
        """Prepare for the instances of one image; `background` (N,) says which of its `samples` lie on none."""
        self._samples = samples
        self._ego = ego
        self._options = options or InstanceMotionOptions()
        self._parallax: Parallax | None = None
        if ego.motion is not None:
            self._parallax = measure_parallax(ego.motion, samples.current, samples.previous)
            view = ViewPair(samples, background, ego.motion, self._parallax)
            self._standing = StandingObjects(view, ground, camera, self._options.standing)

    def assess(self, labels: npt.NDArray[np.uint32], instance_id: int, category: str, box_px: BoxPx) -> MotionEvidence:
        """Evidence for the instance `instance_id` of `category` inside `box_px` of the label image (H, W)."""
        if self._parallax is None or self._ego.motion is None:
            return NO_EVIDENCE
        inside = self._inside(labels, instance_id, box_px)
        if len(inside) < self._options.least_samples:
            return MotionEvidence(0.5, 0.0, 0.0, len(inside))
        if not self._ego.motion.has_baseline:
            return self._without_baseline(self._parallax, inside, box_px)
        lower = inside[self._samples.pixel[inside, 1] >= box_px[1] + (1.0 - self._options.lower_share) * box_px[3]]
        if len(lower) < self._options.least_samples:
            lower = inside
        standing = self._standing.flow_at(lower, find_contact(labels, instance_id, box_px), category)
        return self._with_baseline(self._parallax, inside, lower, standing, box_px)

    def _inside(self, labels: npt.NDArray[np.uint32], instance_id: int, box_px: BoxPx) -> npt.NDArray[np.intp]:
        """Indices of the samples on the instance, off its edge, where flow mixes with that of the background."""
        x, y, width, height = box_px
        mask = (labels[y : y + height, x : x + width] == instance_id).astype(np.uint8)
        margin = int(np.clip(min(width, height) // 10, 1, 5))
        mask = np.asarray(cv2.erode(mask, np.ones((2 * margin + 1, 2 * margin + 1), np.uint8), borderValue=0), np.uint8)
        column, row = self._samples.pixel[:, 0] - x, self._samples.pixel[:, 1] - y
        near = np.flatnonzero((column >= 0) & (row >= 0) & (column < width) & (row < height))
        return near[mask[row[near], column[near]] > 0]

    def _without_baseline(self, parallax: Parallax, inside: npt.NDArray[np.intp], box_px: BoxPx) -> MotionEvidence:
        options, focal = self._options, self._samples.focal_px
        flow_noise_px = options.flow_noise * self._ego.noise_px + options.least_noise_px
        aside, aside_spread = _middle(parallax.across[inside] * focal)
        down, down_spread = _middle(parallax.along[inside] * focal)
        log_odds, noise_px = 0.0, flow_noise_px
        for residual_px, spread in ((aside, aside_spread), (down, down_spread)):
            noise_px = float(np.hypot(flow_noise_px, _of_median(spread, box_px)))
            log_odds += _log_odds(residual_px, noise_px, 1.5 * options.least_expected_px)
        return MotionEvidence(self._probability(log_odds), float(np.hypot(aside, down)), noise_px, len(inside))

    def _with_baseline(
        self,
        parallax: Parallax,
        inside: npt.NDArray[np.intp],
        lower: npt.NDArray[np.intp],
        standing: StandingFlow,
        box_px: BoxPx,
    ) -> MotionEvidence:
        options, focal = self._options, self._samples.focal_px
        length_px = float(np.median(parallax.length[inside])) * focal
        growth = float(flow_noise_growth(np.array(length_px)))
        flow_noise_px = options.flow_noise * self._ego.noise_px * growth + options.least_noise_px
        flow_noise_px *= float(np.sqrt(1.0 + options.few_samples / len(inside)))

        across, spread = _middle(parallax.across[inside] * focal)
        across_noise = _norm(flow_noise_px, options.direction_error * length_px, _of_median(spread, box_px))

        observed = parallax.along[lower] * focal
        beyond, spread = _middle(observed - np.clip(observed, standing.farthest, standing.nearest))
        bound = np.where(np.isfinite(standing.nearest), standing.nearest, standing.farthest)
        expected = np.clip(observed, standing.farthest, bound)
        along_noise = _norm(
            flow_noise_px, float(np.median(standing.error_share * expected)), _of_median(spread, box_px)
        )

        moved_px = max(options.least_expected_px, options.expected_speed * float(np.median(expected)))
        # what moves may well move along its epipolar line alone, so nothing across it is only half an answer
        log_odds = float(np.logaddexp(0.0, _log_odds(across, across_noise, moved_px)) - np.log(2.0))
        if standing.is_bounded or beyond < 0.0:
            log_odds += _log_odds(beyond, along_noise, moved_px)
        return MotionEvidence(self._probability(log_odds), abs(across), across_noise, len(inside), beyond, along_noise)

    def _probability(self, log_odds: float) -> float:
        limit = self._options.largest_log_odds
        return float(1.0 / (1.0 + np.exp(-np.clip(log_odds + self._options.prior_log_odds, -limit, limit))))


def _log_odds(residual_px: float, noise_px: float, moved_px: float) -> float:
    """log p(residual | moves) / p(residual | stands): zero-mean Gaussians, wider by `moved_px` for what moves."""
    standing, moving = noise_px**2, noise_px**2 + moved_px**2
    return 0.5 * float(np.log(standing / moving)) + 0.5 * residual_px**2 * (1.0 / standing - 1.0 / moving)


def _norm(*sigmas: float) -> float:
    return float(np.sqrt(sum(sigma**2 for sigma in sigmas)))


def _middle(values: FloatArray) -> tuple[float, float]:
    middle = float(np.median(values))
    return middle, 1.4826 * float(np.median(np.abs(values - middle)))


def _of_median(spread_px: float, box_px: BoxPx, independent_px: int = 16) -> float:
    """Sigma of a median over a box when flow is independent only from one DIS patch to the next."""
    return spread_px / float(np.sqrt(max(1.0, box_px[2] * box_px[3] / independent_px**2)))
