# SPDX-License-Identifier: Apache-2.0
"""How a message's topic is named in a recording: by its key, with `/<service>` where every service sends its own."""

from schemas.topics import BY_KEY, Topic
from services.runtime.errors import InputError


def key_of(topic: Topic, suffix: str) -> str:
    """The name of `topic` in a recording, for the messages of the service `suffix`; that is empty for most topics."""
    return f"{topic.key}/{suffix}" if suffix else topic.key


def topic_and_suffix(key: str) -> tuple[Topic, str]:
    """The other way round. Raises InputError when no topic is recorded under that name."""
    if key in BY_KEY:
        return BY_KEY[key], ""
    base, _, suffix = key.rpartition("/")
    if base not in BY_KEY:
        raise InputError(f"{key!r}: no topic of kinemap; expected one of {', '.join(BY_KEY)}")
    return BY_KEY[base], suffix
