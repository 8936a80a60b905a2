# SPDX-License-Identifier: Apache-2.0
"""The flow that an object would have if it stood on the ground where its lower edge touches it."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from services.motion.flow_samples import FlowSamples
from services.motion.ground_contact import GroundContact
from services.motion.ground_plane import GroundPlane
from services.motion.two_view import CameraMotion, FloatArray, Parallax, PinholeCamera, predict_along


@dataclass(frozen=True)
class StandingFlowOptions:
    """How well a lower edge tells an object's depth."""

    contact_error_px: float = 0.8
    """of the lower edge of a mask"""
    depth_error: float = 0.06
    """of an object's depth against that of its contact, as a share: bumpers hang over wheels"""
    thin_depth_error: float = 0.03
    """the same of categories that stand straight above their contact"""
    thin_categories: tuple[str, ...] = ("person", "bicycle", "motorcycle")
    slope_error: float = 0.025
    """of that depth, for each camera height that it lies farther aside than two: roads are crowned, verges slope"""
    level_share: float = 0.05
    """that the ground before an object may differ from the plane, in inverse depth, and still be the plane"""
    margin_px: int = 8
    """below an object, where flow mixes with the object's"""
    least_samples: int = 5
    least_along_px: float = 1.0
    """that the ground before an object must move to be compared with the plane"""


@dataclass(frozen=True)
class StandingFlow:
    """Displacements in px along the epipolar lines of N samples of a standing object, between `farthest` and `nearest`.

    `nearest` is infinite where nothing bounds it. `error_share` is the displacement's sigma as a share of it.
    """

    nearest: FloatArray
    farthest: FloatArray
    error_share: FloatArray

    @property
    def is_bounded(self) -> bool:
        """Whether too much displacement is a contradiction too, and not only too little."""
        return bool(np.all(np.isfinite(self.nearest)))


@dataclass(frozen=True)
class ViewPair:
    """The samples of one image pair, which of them lie on no instance (N,), the camera's motion and their parallax."""

    samples: FlowSamples
    background: npt.NDArray[np.bool_]
    motion: CameraMotion
    parallax: Parallax


class StandingObjects:
    """Knows the ground of one image pair."""

    def __init__(
        self, view: ViewPair, ground: GroundPlane | None, camera: PinholeCamera, options: StandingFlowOptions
    ) -> None:
        self._samples = view.samples
        self._background = np.flatnonzero(view.background)
        self._motion = view.motion
        self._parallax = view.parallax
        self._ground = ground
        self._camera = camera
        self._options = options

    def flow_at(self, chosen: npt.NDArray[np.intp], contact: GroundContact | None, category: str) -> StandingFlow:
        """The flow of the samples `chosen` (indices) on an object of `category`.

        It stands on the plane, or on what lies before its lower edge (a kerb, a slope, a bush that hides its wheels).
        Where its lower edge is hidden by an instance or the image's border it may be nearer still. Without ground or
        contact it may be at any depth in front of the camera.
        """
        if self._ground is None or contact is None:
            return StandingFlow(np.full(len(chosen), np.inf), np.zeros(len(chosen)), np.zeros(len(chosen)))
        current, focal = self._samples.current[chosen], self._samples.focal_px
        columns = self._samples.pixel[chosen, 0]
        feet = np.column_stack((columns, contact.rows_at(columns))).astype(np.float64)
        points = self._camera.normalise(feet)
        inverse_depth = np.maximum(self._ground.inverse_depth(points), 0.0)
        low, high = self._ground_before(feet)
        farthest = predict_along(self._motion, current, low * inverse_depth) * focal
        nearest = predict_along(self._motion, current, high * inverse_depth) * focal
        if contact.hidden:
            nearest = np.full(len(chosen), np.inf)
        return StandingFlow(nearest, farthest, self._error_share(points, inverse_depth, category))

    def _error_share(self, points: FloatArray, inverse_depth: FloatArray, category: str) -> FloatArray:
        assert self._ground is not None
        options = self._options
        per_row = 1.0 / (self._samples.focal_px * self._ground.height)
        inverse_depth = np.maximum(inverse_depth, per_row)
        aside = np.abs(points[:, 0]) / (inverse_depth * self._ground.height)
        slope = options.slope_error * np.maximum(aside - 2.0, 0.0)
        depth_error = options.thin_depth_error if category in options.thin_categories else options.depth_error
        contact_error = options.contact_error_px * per_row / inverse_depth
        return np.asarray(np.sqrt(contact_error**2 + depth_error**2 + slope**2))

    def _ground_before(self, feet: FloatArray) -> tuple[float, float]:
        """Least and largest inverse depth of what an object stands on, in the plane's: 1 is always among them."""
        assert self._ground is not None
        options, samples = self._options, self._samples
        left, right = float(feet[:, 0].min()), float(feet[:, 0].max())
        top = float(feet[:, 1].max()) + options.margin_px
        reach = max(16.0, 0.3 * (right - left))
        x, y = samples.pixel[self._background, 0], samples.pixel[self._background, 1]
        before = self._background[(x > left - reach) & (x < right + reach) & (y > top) & (y < top + reach)]
        plane = self._ground.inverse_depth(samples.current[before])
        moves = plane * self._parallax.gain[before] * samples.focal_px > options.least_along_px
        if int(moves.sum()) < options.least_samples:
            return 1.0, 1.0
        factor = float(np.clip(np.median(self._parallax.inverse_depth[before][moves] / plane[moves]), 0.4, 2.5))
        return min(1.0, factor + options.level_share), max(1.0, factor - options.level_share)
