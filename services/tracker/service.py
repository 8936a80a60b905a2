# SPDX-License-Identifier: Apache-2.0
"""The tracker service: motion's instances in, objects that last out."""

from typing import ClassVar

import cv2

from schemas import topics
from schemas.records import MotionState
from schemas.topics import Topic
from services.runtime.config import Config
from services.runtime.config.tracker import TrackerConfig
from services.runtime.host import run_service
from services.runtime.outbox import State
from services.runtime.service import Bundle, FrameService, Outgoing
from services.tracker.association import AssociationOptions
from services.tracker.motion_filter import MotionFilterOptions
from services.tracker.state_arrays import arrays_of_objects, objects_of_arrays
from services.tracker.track_lifecycle import ObjectTracker, TrackerOptions

NAME = "tracker"


def tracker_options(settings: TrackerConfig) -> TrackerOptions:
    """The options of every step, from the configuration's section."""
    return TrackerOptions(
        lost_frames=settings.lost_frames,
        association=AssociationOptions(settings.least_iou, settings.largest_distance),
        motion=MotionFilterOptions(memory=settings.motion_memory, decided_log_odds=settings.decided_log_odds),
    )


class TrackerService(FrameService):
    """Object ids count from 1 and are never given twice in a session."""

    name: ClassVar[str] = NAME
    awaits: ClassVar[tuple[Topic, ...]] = (topics.INSTANCE_MOTIONS,)

    def __init__(self, config: Config) -> None:
        cv2.setNumThreads(1)
        self._tracker = ObjectTracker(tracker_options(config.tracker))
        self._moving = 0

    def process(self, bundle: Bundle) -> list[Outgoing]:
        """Track one frame."""
        objects = self._tracker.update(bundle[topics.INSTANCE_MOTIONS])
        self._moving = sum(row.motion_state is MotionState.MOVING for row in objects.objects)
        return [Outgoing(topics.OBJECTS, objects)]

    def snapshot(self) -> State | None:
        """Every object that is remembered."""
        return arrays_of_objects(self._tracker.objects, self._tracker.next_id)

    def restore(self, state: State) -> None:
        """Go on where a predecessor was killed."""
        self._tracker.objects, self._tracker.next_id = objects_of_arrays(state)

    def metrics(self) -> dict[str, float]:
        """Ids given so far, objects remembered, and those that move in the last frame."""
        return {
            "objects_seen": float(self._tracker.next_id - 1),
            "objects_remembered": float(len(self._tracker.objects)),
            "moving_objects": float(self._moving),
        }


if __name__ == "__main__":
    run_service(TrackerService, NAME)
