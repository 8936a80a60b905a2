# SPDX-License-Identifier: Apache-2.0
"""How the frames of a robot sit on each other (REP-105), composed of what its recording tells."""

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from services.camera.sources.recordings.message_log import StaticTransform

Array = npt.NDArray[np.float64]


class FrameTree:
    """Frames fixed to each other; a leading slash in a name (ROS 1) does not count."""

    def __init__(self, transforms: Iterable[StaticTransform]) -> None:
        self._neighbours: dict[str, dict[str, Array]] = {}
        for transform in transforms:
            parent, child = transform.parent.lstrip("/"), transform.child.lstrip("/")
            self._neighbours.setdefault(parent, {})[child] = transform.parent_from_child
            child_from_parent = np.linalg.inv(transform.parent_from_child)
            self._neighbours.setdefault(child, {})[parent] = np.asarray(child_from_parent, dtype=np.float64)

    def transform(self, target: str, source: str) -> Array | None:
        """(4, 4) target_from_source in metres; None where nothing connects the two."""
        start, goal = target.lstrip("/"), source.lstrip("/")
        found: dict[str, Array] = {start: np.eye(4)}
        waiting = [start]
        while waiting:
            frame = waiting.pop(0)
            for neighbour, frame_from_neighbour in self._neighbours.get(frame, {}).items():
                if neighbour not in found:
                    found[neighbour] = np.asarray(found[frame] @ frame_from_neighbour, dtype=np.float64)
                    waiting.append(neighbour)
        return found.get(goal)
