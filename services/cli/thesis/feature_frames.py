# SPDX-License-Identifier: Apache-2.0
"""Images with what is known of the objects in them: from a run's recording, or from a sequence and its masks."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

import numpy as np

from schemas import topics
from schemas.codec import decode
from schemas.records import Image, MotionState, Objects
from services.camera.configured_source import open_configured_source
from services.cli.flags import Overrides, merge_overrides
from services.cli.run import open_briefly
from services.cli.thesis.segmenter_run import open_segmenter
from services.evaluation.thesis.feature_balance import LabelledImage, SeenObject
from services.formats.label_images import INDEX_NAME, read_label_index
from services.runtime.config import Config, load_config
from services.runtime.errors import InputError
from services.runtime.session_file import SessionFile
from services.segmenter.backend import FrameContext, InstanceBackend
from services.segmenter.label_images import LabelImages

SESSION_NAME = "session.mcap"


class FrameSource(Protocol):
    """Images one after the other, each with the objects in it."""

    folder: Path
    without_masks: int
    """frames so far of which nobody said what is in them"""

    @property
    def frame_count(self) -> int:
        """Frames to come, for who shows how far it is."""

    def __iter__(self) -> Iterator[LabelledImage]: ...


@dataclass
class RecordedFrames:
    """The frames of a run: objects and their motion states as its tracker had them."""

    folder: Path
    limit: int | None = None
    without_masks: int = 0

    @property
    def frame_count(self) -> int:
        """Images in the recording, or the limit."""
        with SessionFile(self.folder / SESSION_NAME) as session:
            recorded = session.message_counts().get(topics.IMAGE.key, 0)
        return recorded if self.limit is None else min(recorded, self.limit)

    def __iter__(self) -> Iterator[LabelledImage]:
        waiting: dict[int, dict[str, bytes]] = {}
        done = 0
        with SessionFile(self.folder / SESSION_NAME) as session:
            wanted = {topics.IMAGE.key, topics.OBJECTS.key}
            for message in session.messages(wanted):
                if self.limit is not None and done >= self.limit:
                    return
                parts = waiting.setdefault(message.sequence, {})
                parts[message.key] = message.payload
                if len(parts) == len(wanted):
                    del waiting[message.sequence]
                    done += 1
                    image: Image = decode(topics.IMAGE, parts[topics.IMAGE.key])
                    objects: Objects = decode(topics.OBJECTS, parts[topics.OBJECTS.key])
                    seen = tuple(SeenObject(row.object_id, row.category, row.motion_state) for row in objects.objects)
                    if objects.track_image.shape == image.pixels.shape[:2]:
                        yield LabelledImage(f"{message.sequence:06d}", image.pixels, objects.track_image, seen)
                    else:
                        self.without_masks += 1
        self.without_masks += len(waiting)


@dataclass
class SequenceFrames:
    """The frames of a sequence and what the configured segmenter finds in them.

    Motion states are known where label images come with an instances.json that says of every instance whether it moves.
    """

    folder: Path
    limit: int | None = None
    config: Path | None = None
    without_masks: int = 0
    _backend: InstanceBackend = field(init=False)

    def __post_init__(self) -> None:
        self._backend = open_segmenter(self.folder, None, config=self.config)

    @property
    def frame_count(self) -> int:
        """Images of the sequence, or the limit."""
        return open_briefly(self._camera())

    def __iter__(self) -> Iterator[LabelledImage]:
        config = self._camera()
        masks = config.segmenter.instances or self.folder / "instances"
        states = _known_states(masks) if isinstance(self._backend, LabelImages) else {}
        source = open_configured_source(config)
        try:
            index = 0
            while (frame := source.frame(index)) is not None:
                index += 1
                found = self._backend.segment(frame.image, FrameContext(frame.name))
                if found.skipped:
                    self.without_masks += 1
                    continue
                known = states.get(frame.name, {})
                seen = tuple(
                    SeenObject(item.instance_id, item.category, known.get(item.instance_id)) for item in found.instances
                )
                yield LabelledImage(frame.name, frame.image.pixels, np.asarray(found.labels), seen)
        finally:
            source.close()
            self._backend.close()

    def _camera(self) -> Config:
        flags: Overrides = {"camera": {"input": str(self.folder), "stereo": False, "max_frames": self.limit}}
        return load_config(self.config, merge_overrides({}, flags))


def _known_states(folder: Path) -> dict[str, dict[int, MotionState]]:
    if not (folder / INDEX_NAME).is_file():
        return {}
    return {
        frame: {
            row.label: MotionState.MOVING if row.moving else MotionState.NON_MOVING
            for row in rows
            if row.moving is not None
        }
        for frame, rows in read_label_index(folder).items()
    }


def require_run(folder: Path) -> None:
    """Raise InputError where `folder` is no run's."""
    if not (folder / SESSION_NAME).is_file():
        raise InputError(f"{folder}: no {SESSION_NAME} here, expected the folder of a run")
