# SPDX-License-Identifier: Apache-2.0
"""The motion service: image and instances in; the camera's motion, instances that move and the moving pixels out."""

from typing import ClassVar

import cv2

from schemas import topics
from schemas.topics import Topic
from services.motion.ego_motion import EgoMotionOptions
from services.motion.flow.options import OpticalFlowOptions
from services.motion.instance_motion import InstanceMotionOptions
from services.motion.motion_refinement import DirectionPrior
from services.motion.scene_motion import SceneMotion, SceneMotionOptions
from services.motion.standing_flow import StandingFlowOptions
from services.motion.state_arrays import arrays_of_state, state_of_arrays
from services.runtime.config import Config
from services.runtime.config.motion import MotionConfig
from services.runtime.host import run_service
from services.runtime.log import get_logger
from services.runtime.outbox import State
from services.runtime.service import Bundle, FrameService, Outgoing

NAME = "motion"


def scene_motion_options(settings: MotionConfig) -> SceneMotionOptions:
    """The options of every step, from the configuration's section."""
    return SceneMotionOptions(
        flow=OpticalFlowOptions(
            settings.flow_preset,
            settings.flow_width_px,
            settings.flow_finest_level,
            settings.flow,
            settings.flow_weights,
            settings.flow_iterations,
            settings.device,
            settings.threads,
        ),
        ego=EgoMotionOptions(
            seed=settings.seed,
            standing_parallax_px=settings.standing_parallax_px,
            prior=DirectionPrior(sigma=settings.heading_sigma),
        ),
        instance=InstanceMotionOptions(
            expected_speed=settings.expected_speed,
            standing=StandingFlowOptions(settings.contact_error_px, settings.depth_error),
        ),
    )


class MotionService(FrameService):
    """Every frame against the one before."""

    name: ClassVar[str] = NAME
    awaits: ClassVar[tuple[Topic, ...]] = (topics.IMAGE, topics.CALIBRATION, topics.INSTANCES)

    def __init__(self, config: Config) -> None:
        cv2.setNumThreads(config.motion.threads)
        self._scene = SceneMotion(scene_motion_options(config.motion))
        self._log = get_logger(NAME)
        self._frames_without_ego_motion = 0
        self._moving_instances = 0

    def process(self, bundle: Bundle) -> list[Outgoing]:
        """Measure one frame."""
        result = self._scene.update(bundle[topics.IMAGE], bundle[topics.CALIBRATION], bundle[topics.INSTANCES])
        instances = result.instance_motions.instances
        self._moving_instances = sum(instance.moving_probability > 0.5 for instance in instances)
        if not result.ego_motion.valid:
            self._frames_without_ego_motion += 1
            self._log.warning_limited(
                "no_ego_motion", reason=result.ego_motion.reason, sequence=bundle.envelope.sequence
            )
        return [
            Outgoing(topics.EGO_MOTION, result.ego_motion),
            Outgoing(topics.INSTANCE_MOTIONS, result.instance_motions),
            Outgoing(topics.MOVING_MASK, result.moving_mask),
        ]

    def snapshot(self) -> State:
        """The image before with its masks, and the motion it ended with; empty before the first image."""
        return arrays_of_state(self._scene.state) if self._scene.state is not None else {}

    def restore(self, state: State) -> None:
        """Go on where a predecessor was killed."""
        if state:
            self._scene.state = state_of_arrays(state)

    def metrics(self) -> dict[str, float]:
        """Frames whose camera motion is unknown, and the instances that move in the last one."""
        return {
            "frames_without_ego_motion": float(self._frames_without_ego_motion),
            "moving_instances": float(self._moving_instances),
        }


if __name__ == "__main__":
    run_service(MotionService, NAME)
