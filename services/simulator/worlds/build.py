# SPDX-License-Identifier: Apache-2.0
"""Which world a drive goes through."""

from __future__ import annotations

from services.runtime.errors import InputError
from services.simulator.options import DriveOptions
from services.simulator.worlds.street.build import build_street
from services.simulator.worlds.world import World


def build_world(options: DriveOptions) -> World:
    """The world that `options` ask for; equal options give equal worlds.

    Raises:
        InputError: options that this world cannot meet.
    """
    builders = {"street": build_street}
    if options.world not in builders:
        raise InputError(f"simulator world={options.world!r}: expected one of {', '.join(builders)}")
    return builders[options.world](options)
