# SPDX-License-Identifier: Apache-2.0
"""When a lost camera gives up its map and begins another: no input may leave tracking lost for good."""

from schemas.records import TrackedFrame, TrackingState


class LostPolicy:
    """Counts lost frames of one map; a young map, which has little to come back to, is given up sooner."""

    YOUNG_KEYFRAMES = 5
    YOUNG_FRAMES = 5

    def __init__(self, new_map_after_frames: int) -> None:
        self._patience = new_map_after_frames
        self._lost = 0
        self._keyframes = 0

    def gives_up(self, frame: TrackedFrame) -> bool:
        """Whether the map of `frame`, the newest one, has been lost for too long."""
        self._keyframes += frame.keyframe_inserted
        self._lost = self._lost + 1 if frame.state is TrackingState.LOST else 0
        young = self._keyframes <= self.YOUNG_KEYFRAMES
        return self._lost >= (min(self.YOUNG_FRAMES, self._patience) if young else self._patience)
