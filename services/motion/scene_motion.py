# SPDX-License-Identifier: Apache-2.0
"""One image after the other: flow, the camera's motion, and which instances move besides."""

from dataclasses import dataclass, field

import cv2
import numpy as np
import numpy.typing as npt

from schemas.records import (
    CameraCalibration,
    EgoMotion,
    Image,
    Instance,
    InstanceMotion,
    InstanceMotions,
    Instances,
    MovingMask,
)
from services.motion.ego_motion import EgoMotionEstimate, EgoMotionEstimator, EgoMotionOptions
from services.motion.flow.algorithm import Pixels
from services.motion.flow.dense_flow import DenseFlow
from services.motion.flow.options import OpticalFlowOptions
from services.motion.flow_samples import FlowSamples, FlowSampling, sample_flow
from services.motion.ground_plane import GroundOptions, GroundPlane, blend_normal, fit_ground
from services.motion.instance_motion import (
    NO_EVIDENCE,
    InstanceMotionEstimator,
    InstanceMotionOptions,
    MotionEvidence,
)
from services.motion.mask_carrier import CarriedMasks, bounding_box, carry_masks
from services.motion.two_view import CameraMotion, FloatArray, PinholeCamera
from services.runtime.errors import InputError


@dataclass(frozen=True)
class SceneMotionOptions:
    """The options of every step."""

    flow: OpticalFlowOptions = field(default_factory=OpticalFlowOptions)
    sampling: FlowSampling = field(default_factory=FlowSampling)
    ego: EgoMotionOptions = field(default_factory=EgoMotionOptions)
    ground: GroundOptions = field(default_factory=GroundOptions)
    instance: InstanceMotionOptions = field(default_factory=InstanceMotionOptions)
    mask_margin_px: int = 4
    """background samples keep this distance from every instance"""


@dataclass(frozen=True)
class SceneMotionState:
    """What one image leaves for the next."""

    timestamp_ns: int
    pixels: Pixels
    """of the image, as the flow takes them"""
    masks: CarriedMasks
    motion: CameraMotion | None
    ground_normal: FloatArray | None


@dataclass(frozen=True)
class SceneMotionResult:
    """What one image gives: the three messages, and the ground for those who look closer."""

    ego_motion: EgoMotion
    instance_motions: InstanceMotions
    moving_mask: MovingMask
    evidence: dict[int, MotionEvidence]
    ground: GroundPlane | None


class SceneMotion:
    """Holds the state from image to image; `state` may be read and set, and is all there is."""

    def __init__(self, options: SceneMotionOptions | None = None) -> None:
        self._options = options or SceneMotionOptions()
        self._flow = DenseFlow(self._options.flow)
        self._ego = EgoMotionEstimator(self._options.ego)
        self.state: SceneMotionState | None = None

    def update(self, image: Image, calibration: CameraCalibration, segmented: Instances) -> SceneMotionResult:
        """Take the next image with its masks (or the word that it was skipped).

        Raise InputError when the label image is not of the image's size.
        """
        shape = image.pixels.shape[:2]
        if not segmented.skipped and segmented.labels.shape != shape:
            raise InputError(f"labels of {segmented.labels.shape}: expected those of the image, {shape}")
        before = self.state
        pixels = self._flow.kept(image.pixels)
        if before is None or before.pixels.shape[:2] != shape:
            return self._first(image, pixels, segmented)

        field = self._flow.previous_from_current(pixels, before.pixels)
        masks = carry_masks(before.masks, field.flow) if segmented.skipped else _fresh(segmented)
        camera = PinholeCamera(
            np.asarray(calibration.intrinsics, dtype=np.float64),
            calibration.distortion,
            fisheye=calibration.distortion_model == "kannala_brandt",
        )
        samples = sample_flow(field, masks.labels, camera, self._options.sampling)
        background = self._background(samples, masks)
        ego = self._ego.estimate(samples, background, before.motion)
        ground = None
        if ego.motion is not None:
            ground = fit_ground(samples, background, ego.motion, before.ground_normal, self._options.ground)
        estimator = InstanceMotionEstimator(
            samples, background, ego, ground=ground, camera=camera, options=self._options.instance
        )
        evidence = {
            instance.instance_id: estimator.assess(
                masks.labels, instance.instance_id, instance.category, _whole_box(instance, shape)
            )
            for instance in masks.instances
        }
        normal = before.ground_normal
        if ground is not None:
            normal = blend_normal(normal, ground.normal, self._options.ground.normal_memory)
        self.state = SceneMotionState(image.timestamp_ns, pixels, masks, ego.motion, normal)
        return _result(image.timestamp_ns, before.timestamp_ns, masks=masks, ego=ego, evidence=evidence, ground=ground)

    def _first(self, image: Image, pixels: Pixels, segmented: Instances) -> SceneMotionResult:
        reason = "first image" if self.state is None else "image of another size than the one before"
        masks = CarriedMasks(np.zeros(pixels.shape[:2], np.uint32), (), 0) if segmented.skipped else _fresh(segmented)
        self.state = SceneMotionState(image.timestamp_ns, pixels, masks, None, None)
        ego = EgoMotionEstimate(None, reason)
        evidence = {instance.instance_id: NO_EVIDENCE for instance in masks.instances}
        return _result(image.timestamp_ns, image.timestamp_ns, masks=masks, ego=ego, evidence=evidence, ground=None)

    def _background(self, samples: FlowSamples, masks: CarriedMasks) -> npt.NDArray[np.bool_]:
        side = 2 * self._options.mask_margin_px + 1
        covered = cv2.dilate((masks.labels != 0).astype(np.uint8), np.ones((side, side), np.uint8))
        return np.asarray(covered[samples.pixel[:, 1], samples.pixel[:, 0]] == 0)


def _fresh(segmented: Instances) -> CarriedMasks:
    """The segmenter's masks, each with the box of its pixels; instances without any pixel are left out."""
    present = []
    for instance in segmented.instances:
        mask = segmented.labels == instance.instance_id
        if mask.any():
            present.append(Instance(instance.instance_id, instance.category, instance.score, bounding_box(mask)))
    return CarriedMasks(segmented.labels, tuple(present), 0)


def _whole_box(instance: Instance, shape: tuple[int, ...]) -> tuple[int, int, int, int]:
    x, y, width, height = (int(value) for value in instance.box_px)
    return x, y, min(width, shape[1] - x), min(height, shape[0] - y)


def _result(
    timestamp_ns: int,
    previous_timestamp_ns: int,
    *,
    masks: CarriedMasks,
    ego: EgoMotionEstimate,
    evidence: dict[int, MotionEvidence],
    ground: GroundPlane | None,
) -> SceneMotionResult:
    motion = ego.motion or CameraMotion(np.eye(3), np.zeros(3))
    moving = np.zeros(masks.labels.shape, np.uint8)
    rows = []
    for instance in masks.instances:
        found = evidence[instance.instance_id]
        if found.moving_probability > 0.5:
            moving[masks.labels == instance.instance_id] = 255
        rows.append(
            InstanceMotion(
                instance.instance_id,
                instance.category,
                instance.score,
                instance.box_px,
                found.moving_probability,
                found.epipolar_residual_px,
                found.residual_noise_px,
                found.samples,
                masks.age_frames,
            )
        )
    return SceneMotionResult(
        EgoMotion(
            timestamp_ns,
            previous_timestamp_ns,
            ego.motion is not None,
            ego.reason,
            motion.rotation.T,
            -motion.rotation.T @ motion.translation,
            ego.inlier_ratio,
            ego.samples,
            ego.background_flow_px,
            ego.parallax_px,
        ),
        InstanceMotions(timestamp_ns, masks.labels, tuple(rows)),
        MovingMask(timestamp_ns, moving),
        evidence,
        ground,
    )
