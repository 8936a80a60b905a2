# SPDX-License-Identifier: Apache-2.0
"""Which inputs are cameras that see now, by their address alone."""

import re

_DEVICE = re.compile(r"(?:/dev/video)?(\d{1,3})")
_STREAM = re.compile(r"(?:rtsps?|rtmp|https?|udp|tcp)://\S+", re.IGNORECASE)


def is_live(given: str) -> bool:
    """Whether `given` is a video device (0, /dev/video0) or a stream (rtsp://, http://): it has no frames to repeat."""
    return device_number(given) is not None or _STREAM.fullmatch(given) is not None


def device_number(given: str) -> int | None:
    """The number of a video device, None for what is none."""
    found = _DEVICE.fullmatch(given)
    return None if found is None else int(found[1])


def without_credentials(given: str) -> str:
    """The address as it may be logged and shown: user and password replaced by dots."""
    return re.sub(r"(?<=://)[^/@\s]+@", "...@", given)
