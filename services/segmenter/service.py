# SPDX-License-Identifier: Apache-2.0
"""The segmenter service: an image in, its potentially dynamic instances out."""

import time
from pathlib import Path
from typing import ClassVar

import cv2

from schemas import topics
from schemas.topics import Topic
from services.runtime.config import Config
from services.runtime.config.segmenter import SegmenterConfig
from services.runtime.host import run_service
from services.runtime.log import get_logger
from services.runtime.service import Bundle, FrameService, Outgoing
from services.segmenter.backend import FrameContext, InstanceBackend, InstanceFilter, skipped_frame
from services.segmenter.configured_network import configured_network
from services.segmenter.keyframes import AsOftenAsPossible, EveryNth
from services.segmenter.label_images import LabelImages
from services.segmenter.no_instances import NoInstances
from services.segmenter.recorded import SESSION_SUFFIX, RecordedInstances
from services.segmenter.truth import TrueLabels
from services.segmenter.weights.choice import has_model

NAME = "segmenter"
_FOLDER = "instances"


def choose_backend(config: Config) -> InstanceBackend:
    """The backend that the configuration names.

    `auto` takes, in this order: label images where there is a folder of them, what a recorded session holds when that
    is the input, a network where there is one, and the truth that frames carry.

    Raises:
        InputError: what the backend reads is missing or cannot be used.
    """
    settings = config.segmenter
    source = Path(config.camera.input)
    chosen = InstanceFilter(frozenset(settings.categories), settings.min_score)
    folder = settings.instances or source / _FOLDER
    backend = _first_there_is(settings, source) if settings.backend == "auto" else settings.backend
    match backend:
        case "masks":
            return LabelImages(folder, chosen)
        case "recorded":
            return RecordedInstances(source, chosen)
        case "solov2":
            return configured_network(settings, chosen)
        case "truth":
            return TrueLabels(chosen)
        case _:
            return NoInstances()


def _first_there_is(settings: SegmenterConfig, source: Path) -> str:
    if settings.instances or (source / _FOLDER).is_dir():
        return "masks"
    if source.suffix.lower() == SESSION_SUFFIX:
        return "recorded"
    return "solov2" if has_model(settings.weights) else "truth"


class SegmenterService(FrameService):
    """Has no memory in `lossless`: every frame is its own, so a repeated one gives the same bytes again."""

    name: ClassVar[str] = NAME
    awaits: ClassVar[tuple[Topic, ...]] = (topics.IMAGE, topics.TRUE_INSTANCES)
    most_pending: ClassVar[int | None] = 2
    """The camera sends what belongs to a frame in one go: one may be incomplete while the next begins."""

    def __init__(self, config: Config) -> None:
        self._backend = choose_backend(config)
        self._keyframes = _keyframes(config)
        self._log = get_logger(NAME)
        self._log.info("backend", name=type(self._backend).__name__)

    def process(self, bundle: Bundle) -> list[Outgoing]:
        """Segment one image."""
        context = FrameContext(bundle[topics.MANIFEST].frame_name, bundle.get(topics.TRUE_INSTANCES))
        image = bundle[topics.IMAGE]
        if not self._keyframes.is_due(bundle.envelope.sequence, image.timestamp_ns):
            return [Outgoing(topics.INSTANCES, skipped_frame(image))]
        begun_ns = time.perf_counter_ns()
        instances = self._backend.segment(image, context)
        self._keyframes.took(time.perf_counter_ns() - begun_ns)
        if instances.skipped:
            self._log.warning_limited("frame_skipped", frame=context.frame_name, sequence=bundle.envelope.sequence)
        return [Outgoing(topics.INSTANCES, instances)]

    def metrics(self) -> dict[str, float]:
        """How many frames had no masks though they should have had, and how many frames lie between two that have."""
        return {
            "frames_without_masks": float(self._backend.missing_frames),
            "segmented_every": float(self._keyframes.every),
        }

    def close(self) -> None:
        """Let go of what the backend holds."""
        self._backend.close()


def _keyframes(config: Config) -> EveryNth | AsOftenAsPossible:
    every = config.segmenter.every
    if every is None and config.delivery.mode == "realtime":
        return AsOftenAsPossible()
    return EveryNth(every or 1)


def create(config: Config) -> SegmenterService:
    """The service as configured."""
    # What a broken image is like is said once, in our own line.
    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    return SegmenterService(config)


if __name__ == "__main__":
    run_service(create, NAME)
