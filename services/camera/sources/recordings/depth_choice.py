# SPDX-License-Identifier: Apache-2.0
"""Which of a recording's topics is the depth of its images, where the user named none."""

from services.camera.sources.association import FARTHEST_NS, nearest_pairs
from services.camera.sources.recordings.message_log import LoggedMessage, MessageLog
from services.camera.sources.recordings.message_pixels import depth_pixels, image_pixels
from services.camera.sources.recordings.message_topics import ChosenTopics
from services.runtime.errors import InputError


def registered_depth(
    log: MessageLog, topics: ChosenTopics, images: list[LoggedMessage], notes: list[str]
) -> str | None:
    """The one of `topics.possible_depths` that lies on the images' pixels: of their size and frame, for half of them.

    What was chosen, or why nothing was, goes to `notes`. Raises InputError for a recording that is damaged.
    """
    if not topics.possible_depths:
        return None
    first = log.image(topics.image, images[0])
    size = image_pixels(first, f"{log.name} {topics.image} message 0").shape[:2]
    registered: dict[str, list[int]] = {}
    for topic in topics.possible_depths:
        places = log.index(topic)
        if not places:
            continue
        message = log.image(topic, places[0])
        try:
            shape = depth_pixels(message, f"{log.name} {topic} message 0").shape
        except InputError:
            continue
        if shape == size and message.frame_id.lstrip("/") == first.frame_id.lstrip("/"):
            registered[topic] = sorted(place.stamp_ns for place in places)
    listed = ", ".join(registered or topics.possible_depths)
    why = "several could be the images' depth" if registered else "none is of the images' size and frame"
    if len(registered) == 1:
        pairs = nearest_pairs([place.stamp_ns for place in images], registered[listed], FARTHEST_NS)
        if 2 * len(pairs) >= len(images):
            notes.append(f"{listed} is taken as the images' depth: same size and frame")
            return listed
        why = f"only {len(pairs)} of {len(images)} images have one within 0.02 s"
    notes.append(f"depth is not used: {why} ({listed}); camera.depth_topic names one")
    return None
