# SPDX-License-Identifier: Apache-2.0
"""The probability that an instance moves by itself, the camera's motion taken out."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from services.motion.ego_motion import EgoMotionEstimate
from services.motion.flow_samples import FlowSamples
from services.motion.ground_contact import GroundContact, find_contact
from services.motion.ground_plane import GroundPlane
from services.motion.motion_refinement import flow_noise_growth
from services.motion.two_view import FloatArray, Parallax, measure_parallax, normalise, predict_along


@dataclass(frozen=True)
class InstanceMotionOptions:
    """How sure each kind of evidence is."""

    least_samples: int = 5
    few_samples: int = 16
    """at so many samples the flow's noise counts 1.4 times: they lie at edges, or between things that hide the rest"""
    least_noise_px: float = 0.1
    direction_error: float = 0.012
    """rad, of the camera's direction of travel: across the epipolar line in shares of the parallax"""
    contact_error_px: float = 0.8
    """of the lower edge of a mask"""
    depth_error: float = 0.045
    """of an object's depth against that of its contact, as a share: bumpers hang over wheels"""
    thin_depth_error: float = 0.03
    """the same of categories that stand straight above their contact"""
    thin_categories: tuple[str, ...] = ("person", "bicycle", "motorcycle")
    slope_error: float = 0.02
    """of that depth, for each camera height that it lies farther aside than two: roads are crowned, verges slope"""
    level_share: float = 0.05
    """that the ground before an object may differ from the plane, in inverse depth, and still be the plane"""
    ground_margin_px: int = 8
    """below an object, where flow mixes with the object's"""
    expected_speed: float = 0.25
    """of what moves, in the camera's own speed"""
    least_expected_px: float = 1.0
    prior_log_odds: float = 0.3
    """that what a segmenter calls potentially dynamic moves, before anything is measured"""
    largest_log_odds: float = 4.0
    lower_share: float = 0.6
    """the share of an instance, from below, whose depth is compared with that of its contact"""


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
    expected_along_px: float = 0.0
    """displacement along the epipolar line of a thing standing on the ground there"""


NO_EVIDENCE = MotionEvidence(0.5, 0.0, 0.0, 0)


class InstanceMotionEstimator:
    """Compares an instance's flow with the flow it would have if it stood where it touches the ground.

    Across the epipolar line the answer needs no depth. Along it (a car ahead, or oncoming, on a straight street) any
    speed looks like some depth (the degenerate case of Yuan et al., PAMI 2007), so the depth is taken from the ground
    under the object: a car ahead at our own speed shows no parallax although near, one pulling away a negative depth, an
    oncoming one is too near for where it stands. Where the contact is hidden only "too far" remains a contradiction.
    """

    def __init__(
        self,
        samples: FlowSamples,
        background: npt.NDArray[np.bool_],
        ego: EgoMotionEstimate,
        ground: GroundPlane | None,
        options: InstanceMotionOptions | None = None,
    ) -> None:
        """Prepare for the instances of one image. `samples` are those of all of it, `background` (N,) those on no instance."""
        self._samples = samples
        self._background = np.flatnonzero(background)
        self._ego = ego
        self._ground = ground
        self._options = options or InstanceMotionOptions()
        self._parallax: Parallax | None = None
        if ego.motion is not None:
            self._parallax = measure_parallax(ego.motion, samples.current, samples.previous)

    def assess(
        self,
        labels: npt.NDArray[np.uint32],
        instance_id: int,
        box_px: tuple[int, int, int, int],
        intrinsics: FloatArray,
        distortion: tuple[float, ...] = (),
        category: str = "car",
    ) -> MotionEvidence:
        """Evidence for the instance `instance_id` of `category` inside `box_px` (x, y, width, height) of the label image (H, W)."""
        if self._parallax is None or self._ego.motion is None:
            return NO_EVIDENCE
        inside = self._inside(labels, instance_id, box_px)
        if len(inside) < self._options.least_samples:
            return MotionEvidence(0.5, 0.0, 0.0, len(inside))
        if not self._ego.motion.has_baseline:
            return self._without_baseline(inside, box_px)
        contact = find_contact(labels, instance_id, box_px)
        thin = category in self._options.thin_categories
        depth_error = self._options.thin_depth_error if thin else self._options.depth_error
        return self._with_baseline(inside, box_px, contact, depth_error, intrinsics, distortion)

    def _inside(
        self, labels: npt.NDArray[np.uint32], instance_id: int, box_px: tuple[int, int, int, int]
    ) -> npt.NDArray[np.intp]:
        """Indices of the samples on the instance, off its edge, where flow mixes with that of the background."""
        x, y, width, height = box_px
        mask = (labels[y : y + height, x : x + width] == instance_id).astype(np.uint8)
        margin = int(np.clip(min(width, height) // 10, 1, 5))
        mask = cv2.erode(mask, np.ones((2 * margin + 1, 2 * margin + 1), np.uint8), borderValue=0)
        column, row = self._samples.pixel[:, 0] - x, self._samples.pixel[:, 1] - y
        near = np.flatnonzero((column >= 0) & (row >= 0) & (column < width) & (row < height))
        return near[mask[row[near], column[near]] > 0]

    def _without_baseline(
        self, inside: npt.NDArray[np.intp], box_px: tuple[int, int, int, int]
    ) -> MotionEvidence:
        assert self._parallax is not None
        options, focal = self._options, self._samples.focal_px
        log_odds, residuals, noise_px = 0.0, [], options.least_noise_px
        for part in (self._parallax.across[inside], self._parallax.along[inside]):
            middle, spread = _middle(part * focal)
            noise_px = float(np.hypot(2.0 * self._ego.noise_px + options.least_noise_px, _of_median(spread, box_px)))
            log_odds += _log_odds(middle, noise_px, 1.5 * options.least_expected_px)
            residuals.append(middle)
        return MotionEvidence(self._probability(log_odds), float(np.hypot(*residuals)), noise_px, len(inside))

    def _with_baseline(
        self,
        inside: npt.NDArray[np.intp],
        box_px: tuple[int, int, int, int],
        contact: GroundContact | None,
        depth_error: float,
        intrinsics: FloatArray,
        distortion: tuple[float, ...],
    ) -> MotionEvidence:
        assert self._parallax is not None and self._ego.motion is not None
        options, focal = self._options, self._samples.focal_px
        across, spread = _middle(self._parallax.across[inside] * focal)
        length_px = float(np.median(self._parallax.length[inside])) * focal
        flow_noise_px = 2.0 * self._ego.noise_px * float(flow_noise_growth(np.array(length_px))) + options.least_noise_px
        flow_noise_px *= float(np.sqrt(1.0 + options.few_samples / len(inside)))
        across_noise = float(
            np.linalg.norm((flow_noise_px, options.direction_error * length_px, _of_median(spread, box_px)))
        )

        lower = inside[self._samples.pixel[inside, 1] >= box_px[1] + (1.0 - options.lower_share) * box_px[3]]
        if len(lower) < options.least_samples:
            lower = inside
        nearest, farthest, share = self._standing_along(lower, contact, depth_error, intrinsics, distortion)
        observed = self._parallax.along[lower] * focal
        beyond, along_spread = _middle(observed - np.clip(observed, farthest, nearest))
        expected = np.clip(observed, farthest, np.where(np.isfinite(nearest), nearest, farthest))
        expected_px = float(np.median(expected))
        along_noise = float(
            np.linalg.norm((flow_noise_px, float(np.median(share * expected)), _of_median(along_spread, box_px)))
        )
        along_known = bool(np.all(np.isfinite(nearest))) or beyond < 0.0

        moved_px = max(options.least_expected_px, options.expected_speed * expected_px)
        # what moves may well move along its epipolar line alone, so nothing across it is only half an answer
        log_odds = float(np.logaddexp(0.0, _log_odds(across, across_noise, moved_px)) - np.log(2.0))
        if along_known:
            log_odds += _log_odds(beyond, along_noise, moved_px)
        return MotionEvidence(
            self._probability(log_odds), abs(across), across_noise, len(inside), beyond, along_noise, expected_px
        )

    def _standing_along(
        self,
        chosen: npt.NDArray[np.intp],
        contact: GroundContact | None,
        depth_error: float,
        intrinsics: FloatArray,
        distortion: tuple[float, ...],
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Displacements in px along the epipolar lines if the object stood: the largest and least, and their sigma as a share.

        It stands on the plane, or on what lies before its lower edge (a kerb, a slope, a bush that hides its wheels). Where
        its lower edge is hidden by an instance or the image's border it may be nearer still.
        """
        assert self._ego.motion is not None
        if self._ground is None or contact is None:
            return np.full(len(chosen), np.inf), np.zeros(len(chosen)), np.zeros(len(chosen))
        options, samples = self._options, self._samples
        columns = samples.pixel[chosen, 0]
        feet = np.column_stack((columns, contact.rows_at(columns))).astype(np.float64)
        points = normalise(feet, intrinsics, distortion)
        inverse_depth = np.maximum(self._ground.inverse_depth(points), 0.0)
        low, high = self._ground_before(feet)
        farthest, nearest = (
            predict_along(self._ego.motion, samples.current[chosen], factor * inverse_depth) * samples.focal_px
            for factor in (low, high)
        )
        if contact.hidden:
            nearest = np.full(len(chosen), np.inf)
        per_row = 1.0 / (samples.focal_px * self._ground.height)
        inverse_depth = np.maximum(inverse_depth, per_row)
        aside = np.abs(points[:, 0]) / (inverse_depth * self._ground.height)
        share = np.linalg.norm(
            np.broadcast_arrays(
                options.contact_error_px * per_row / inverse_depth,
                depth_error,
                options.slope_error * np.maximum(aside - 2.0, 0.0),
            ),
            axis=0,
        )
        return nearest, farthest, share

    def _ground_before(self, feet: FloatArray) -> tuple[float, float]:
        """Least and largest inverse depth of what lies before an object's lower edge, in the plane's; 1 lies between."""
        assert self._parallax is not None and self._ground is not None
        options, samples = self._options, self._samples
        left, right = float(feet[:, 0].min()), float(feet[:, 0].max())
        low = float(feet[:, 1].max()) + options.ground_margin_px
        reach = max(16.0, 0.3 * (right - left))
        x, y = samples.pixel[self._background, 0], samples.pixel[self._background, 1]
        before = self._background[(x > left - reach) & (x < right + reach) & (y > low) & (y < low + reach)]
        plane = self._ground.inverse_depth(samples.current[before])
        moves = plane * self._parallax.gain[before] * samples.focal_px > options.least_expected_px
        if int(moves.sum()) < options.least_samples:
            return 1.0, 1.0
        factor = float(np.clip(np.median(self._parallax.inverse_depth[before][moves] / plane[moves]), 0.4, 2.5))
        return min(1.0, factor + options.level_share), max(1.0, factor - options.level_share)

    def _probability(self, log_odds: float) -> float:
        limit = self._options.largest_log_odds
        return float(1.0 / (1.0 + np.exp(-np.clip(log_odds + self._options.prior_log_odds, -limit, limit))))


def _log_odds(residual_px: float, noise_px: float, moved_px: float) -> float:
    """log p(residual | moves) / p(residual | stands): zero-mean Gaussians, wider by `moved_px` for what moves."""
    standing, moving = noise_px**2, noise_px**2 + moved_px**2
    return 0.5 * float(np.log(standing / moving)) + 0.5 * residual_px**2 * (1.0 / standing - 1.0 / moving)


def _middle(values: FloatArray) -> tuple[float, float]:
    middle = float(np.median(values))
    return middle, 1.4826 * float(np.median(np.abs(values - middle)))


def _of_median(spread_px: float, box_px: tuple[int, int, int, int], independent_px: int = 16) -> float:
    """Sigma of a median over a box when flow is independent only from one DIS patch to the next."""
    return spread_px / float(np.sqrt(max(1.0, box_px[2] * box_px[3] / independent_px**2)))
