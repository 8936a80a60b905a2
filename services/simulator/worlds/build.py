# SPDX-License-Identifier: Apache-2.0
"""Which world a drive goes through."""

from __future__ import annotations

from services.simulator.options import DriveOptions
from services.simulator.worlds.corridor.build import build_corridor
from services.simulator.worlds.street.build import build_street
from services.simulator.worlds.town.build import build_town
from services.simulator.worlds.world import World


def build_world(options: DriveOptions) -> World:
    """The world that `options` ask for; equal options give equal worlds.

    Raises:
        InputError: options that this world cannot meet.
    """
    builders = {"street": build_street, "town": build_town, "corridor": build_corridor}
    return builders[options.world](options)
