# SPDX-License-Identifier: Apache-2.0
"""Which topics of a recording are the camera's."""

from dataclasses import dataclass

from services.camera.sources.recordings.message_log import Kind, LoggedTopic, MessageLog
from services.runtime.errors import InputError

_OPTION_OF: dict[Kind, str] = {"image": "camera.topic", "info": "camera.info_topic", "pose": "camera.truth_topic"}
_WORDS: dict[Kind, str] = {"image": "image", "info": "calibration", "pose": "pose"}


@dataclass(frozen=True)
class TopicOptions:
    """Topics as the user named them; None where he did not."""

    image: str | None = None
    depth: str | None = None
    info: str | None = None
    truth: str | None = None
    use_depth: bool = True


@dataclass(frozen=True)
class ChosenTopics:
    """The topics to read; None for what there is none of."""

    image: str
    depth: str | None
    info: str | None
    truth: str | None
    possible_depths: tuple[str, ...] = ()
    """where depth was not named: topics that could be it by their names"""


def choose_topics(log: MessageLog, options: TopicOptions) -> ChosenTopics:
    """The topics that were named, and of images and calibrations the only one or the one that goes with the images.

    Raises:
        InputError: a named topic is not there or of another kind, there are no images, or there are several topics
            and nothing says which one; lists what there is.
    """
    image = _named(log, "image", options.image) if options.image else _only_image(log)
    depth = _named(log, "image", options.depth, "camera.depth_topic") if options.depth else None
    return ChosenTopics(
        image,
        depth if options.use_depth else None,
        _named(log, "info", options.info) if options.info else _info_of(log, image),
        _named(log, "pose", options.truth) if options.truth else None,
        _depths_beside(log, image) if options.use_depth and depth is None else (),
    )


def _of_kind(log: MessageLog, kind: Kind) -> list[LoggedTopic]:
    return [topic for topic in log.topics if topic.kind == kind]


def _listed(topics: list[LoggedTopic]) -> str:
    return ", ".join(f"{topic.name} ({topic.type_name}, {topic.messages})" for topic in topics) or "none"


def _named(log: MessageLog, kind: Kind, name: str, option: str | None = None) -> str:
    known = _of_kind(log, kind)
    if name not in (topic.name for topic in known):
        given = f"{option or _OPTION_OF[kind]} {name}"
        raise InputError(f"{log.name}: {given}, expected one of its {_WORDS[kind]} topics: {_listed(known)}")
    return name


def _depths_beside(log: MessageLog, image: str) -> tuple[str, ...]:
    return tuple(topic.name for topic in _of_kind(log, "image") if _is_called_depth(topic) and topic.name != image)


def _is_called_depth(topic: LoggedTopic) -> bool:
    return "depth" in topic.name.lower()


def _only_image(log: MessageLog) -> str:
    images = _of_kind(log, "image")
    known = [topic for topic in images if not _is_called_depth(topic)] or images
    if not known:
        raise InputError(f"{log.name}: no image topic, expected images of sensor_msgs or foxglove")
    if len(known) > 1:
        raise InputError(
            f"{log.name}: {len(known)} image topics, expected camera.topic to name one of {_listed(known)}"
        )
    return known[0].name


def _info_of(log: MessageLog, image: str) -> str | None:
    """The calibration topic that is a neighbour of the images', such as /cam/camera_info of /cam/image_raw."""
    known = [topic.name for topic in _of_kind(log, "info")]
    parts = image.split("/")
    # image_raw/compressed lies one level deeper than image_raw.
    for depth in range(len(parts) - 1, 0, -1):
        neighbours = [name for name in known if name.split("/")[:-1] == parts[:depth]]
        if len(neighbours) == 1:
            return neighbours[0]
    return known[0] if len(known) == 1 else None
