# SPDX-License-Identifier: Apache-2.0
"""What can go wrong, by who can mend it. Handled once, at the entry points, without a traceback."""

from schemas.errors import KinemapError, ProtocolError

__all__ = ["InputError", "KinemapError", "ProtocolError", "ResourceError"]


class InputError(KinemapError):
    """Input a user gave (file, folder, option, request) that cannot be used."""

    exit_code = 2


class ResourceError(KinemapError):
    """A resource of this machine that is not to be had: a port in use, a full disk."""

    exit_code = 2
