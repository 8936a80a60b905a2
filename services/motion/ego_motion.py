# SPDX-License-Identifier: Apache-2.0
"""The camera's own motion between two images, from the flow of the background."""

from dataclasses import dataclass, field

import cv2
import numpy as np
import numpy.typing as npt

from services.motion.flow_samples import FlowSamples
from services.motion.motion_refinement import (
    DirectionPrior,
    flow_noise_growth,
    motion_cost,
    refine_motion,
    refine_rotation,
)
from services.motion.two_view import CameraMotion, FloatArray, measure_parallax


@dataclass(frozen=True)
class EgoMotionOptions:
    """When two images are enough to say how the camera moved."""

    seed: int = 20
    cell_px: int = 16
    """one sample, the best textured, in each cell of this size: spread over the image"""
    least_samples: int = 40
    hypothesis_samples: int = 600
    inlier_px: float = 1.0
    least_inlier_ratio: float = 0.35
    prior: DirectionPrior = field(default_factory=DirectionPrior)
    standing_parallax_px: float = 0.35
    """background displacement (90 % quantile) left after rotation, below which the camera stands or only turns"""


@dataclass(frozen=True)
class EgoMotionEstimate:
    """The camera's motion with what speaks for it. `motion` is None where it is not known, and `reason` says why."""

    motion: CameraMotion | None
    reason: str
    samples: int = 0
    inlier_ratio: float = 0.0
    noise_px: float = 0.0
    """sigma of the background's distance from its epipolar line, for small flow (see `flow_noise_growth`)"""
    background_flow_px: float = 0.0
    parallax_px: float = 0.0


class EgoMotionEstimator:
    """Five-point essential matrix (Nister 2004) scored by MAGSAC++ (Barath et al. 2020), then robust least squares.

    The motion of the image before is a second hypothesis: where traffic fills the view, the better of the two is kept.
    Whether there is a baseline at all is asked first, as an essential matrix of a pure rotation means nothing.
    """

    def __init__(self, options: EgoMotionOptions | None = None) -> None:
        self._options = options or EgoMotionOptions()

    def estimate(
        self, samples: FlowSamples, background: npt.NDArray[np.bool_], before: CameraMotion | None = None
    ) -> EgoMotionEstimate:
        """Estimate from those `samples` where `background` (N,) is true; `before` is the motion one image earlier."""
        options = self._options
        chosen = samples.where(_best_of_each_cell(samples, background, options.cell_px))
        if len(chosen) < options.least_samples:
            return EgoMotionEstimate(
                None, f"{len(chosen)} background samples, at least {options.least_samples} are needed", len(chosen)
            )
        flow_px = float(np.median(np.hypot(*chosen.flow_px.T)))
        turned = refine_rotation(chosen)
        left_px = measure_parallax(turned, chosen.current, chosen.previous).length * chosen.focal_px
        parallax_px = float(np.quantile(left_px, 0.9))
        if parallax_px < options.standing_parallax_px:
            noise_px = float(np.median(left_px)) / np.sqrt(2 * np.log(2))  # the median of a Rayleigh distribution
            return EgoMotionEstimate(
                turned, "no baseline", len(chosen), float(np.mean(left_px < 1.0)), noise_px, flow_px, parallax_px
            )
        motion, noise_px, inlier_ratio = self._best_motion(chosen, before)
        if inlier_ratio < options.least_inlier_ratio:
            reason = f"{inlier_ratio:.0%} of the background agrees, at least {options.least_inlier_ratio:.0%} is needed"
            return EgoMotionEstimate(None, reason, len(chosen), inlier_ratio, noise_px, flow_px, parallax_px)
        rotated = CameraMotion(motion.rotation, np.zeros(3))
        left_px = measure_parallax(rotated, chosen.current, chosen.previous).length * chosen.focal_px
        return EgoMotionEstimate(
            motion, "", len(chosen), inlier_ratio, noise_px, flow_px, float(np.quantile(left_px, 0.9))
        )

    def _best_motion(self, samples: FlowSamples, before: CameraMotion | None) -> tuple[CameraMotion, float, float]:
        starts = [self._from_essential_matrix(samples)]
        starts.append(before if before is not None and before.has_baseline else self._straight_on())
        refined = [refine_motion(start, samples, self._options.prior) for start in starts if start is not None]
        motion = min(refined, key=lambda candidate: motion_cost(candidate, samples, self._options.prior))
        parallax = measure_parallax(motion, samples.current, samples.previous)
        along_px = parallax.along * samples.focal_px
        across_px = np.abs(parallax.across) * samples.focal_px / flow_noise_growth(along_px)
        inlier = (across_px < self._options.inlier_px) & (along_px > -2.0 * self._options.inlier_px)
        return motion, 1.4826 * float(np.median(across_px)), float(np.mean(inlier))

    def _straight_on(self) -> CameraMotion:
        return CameraMotion(np.eye(3), np.array(self._options.prior.direction))

    def _from_essential_matrix(self, samples: FlowSamples) -> CameraMotion | None:
        strongest = np.argsort(-samples.texture, kind="stable")[: self._options.hypothesis_samples]
        current, previous = samples.current[strongest], samples.previous[strongest]
        parameters = cv2.UsacParams()
        parameters.randomGeneratorState = self._options.seed
        parameters.threshold = self._options.inlier_px / samples.focal_px
        parameters.confidence = 0.999
        parameters.maxIterations = 300
        parameters.score = cv2.SCORE_METHOD_MAGSAC
        parameters.loMethod = cv2.LOCAL_OPTIM_SIGMA
        parameters.sampler = cv2.SAMPLING_UNIFORM
        identity, undistorted = np.eye(3), np.zeros(5)
        essential, _ = cv2.findEssentialMat(
            current, previous, identity, identity, undistorted, undistorted, params=parameters
        )
        if essential is None or essential.shape != (3, 3):
            return None
        return _in_front(np.asarray(essential, np.float64), current, previous)


def _in_front(essential: FloatArray, current: FloatArray, previous: FloatArray) -> CameraMotion:
    """Of the four motions of an essential matrix, the one that puts most points in front of the camera."""
    first, second, direction = cv2.decomposeEssentialMat(essential)
    motions = [
        CameraMotion(np.asarray(rotation, np.float64), np.asarray(sign * direction[:, 0], np.float64))
        for rotation in (first, second)
        if np.trace(rotation) > 1.0
        for sign in (1.0, -1.0)
    ]
    counts = [int(np.sum(measure_parallax(motion, current, previous).along > 0)) for motion in motions]
    return motions[int(np.argmax(counts))]


def _best_of_each_cell(samples: FlowSamples, allowed: npt.NDArray[np.bool_], cell_px: int) -> npt.NDArray[np.intp]:
    """Indices of the best textured allowed sample in each square cell of the image, in the order of the cells."""
    index = np.flatnonzero(allowed)
    cell = samples.pixel[index] // cell_px
    key = cell[:, 1].astype(np.int64) * 100_000 + cell[:, 0]
    order = np.lexsort((-samples.texture[index], key))
    _, first = np.unique(key[order], return_index=True)
    return index[order[first]]
