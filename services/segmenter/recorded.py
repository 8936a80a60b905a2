# SPDX-License-Identifier: Apache-2.0
"""Backend `recorded`: the instances of a recorded session, so that its camera alone gives the same map again."""

from pathlib import Path

from schemas import topics
from schemas.codec import decode
from schemas.records import Image, Instances
from services.runtime.errors import InputError, ProtocolError
from services.runtime.session_file import SessionFile
from services.segmenter.backend import Candidate, FrameContext, InstanceFilter, skipped_frame

SESSION_SUFFIX = ".mcap"


class RecordedInstances:
    """Finds a frame's instances by its capture time; a frame that the session has none of is skipped and counted.

    Raises:
        InputError: no session, or one that is cut off or damaged.
    """

    def __init__(self, path: Path, chosen: InstanceFilter) -> None:
        self._file = SessionFile(path)
        self._filter = chosen
        self._places = {place.timestamp_ns: place for place in self._file.index_of(topics.INSTANCES.key)}
        self.missing_frames = 0

    def segment(self, image: Image, context: FrameContext) -> Instances:
        place = self._places.get(image.timestamp_ns)
        if place is None:
            self.missing_frames += 1
            return skipped_frame(image)
        try:
            recorded: Instances = decode(topics.INSTANCES, self._file.at(place).payload)
        except ProtocolError as error:
            raise InputError(f"{self._file.path}: instances of frame {context.frame_name}: {error}") from error
        if recorded.skipped:
            return skipped_frame(image)
        if recorded.labels.shape != image.pixels.shape[:2]:
            raise InputError(
                f"{self._file.path}: instances of frame {context.frame_name}: {recorded.labels.shape[1]}x"
                f"{recorded.labels.shape[0]} px, expected {image.pixels.shape[1]}x{image.pixels.shape[0]} as its image"
            )
        candidates = [Candidate(item.instance_id, item.category, item.score) for item in recorded.instances]
        return self._filter.choose(image.timestamp_ns, recorded.labels, candidates)

    def close(self) -> None:
        self._file.close()
