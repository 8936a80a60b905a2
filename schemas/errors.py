# SPDX-License-Identifier: Apache-2.0
"""The one exception root, and what can be wrong with a message."""


class KinemapError(Exception):
    """Anything kinemap itself raises. The message is one line: the value, and what was expected."""

    exit_code = 1


class ProtocolError(KinemapError):
    """A message that is cut off, of another version, or not what its topic carries."""
