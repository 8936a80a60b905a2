# SPDX-License-Identifier: Apache-2.0
"""The map files that a run names: whether they can be what is asked of them, before anything is started."""

import os

from services.runtime.config import Config
from services.runtime.errors import InputError

_MAGIC = b"KINEMAP\n"


def require_map_files(config: Config) -> None:
    """Raises InputError when the map to begin in is none, or the one to save has no place to go to.

    The slam service looks at the map's contents; this is for what would end a run that has only just begun.
    """
    given, save = config.slam.map_file, config.slam.save_map
    if given is not None:
        if not given.is_file():
            raise InputError(f"--map {given}: no such file, expected one that --save-map wrote")
        with given.open("rb") as file:
            if file.read(len(_MAGIC)) != _MAGIC:
                raise InputError(f"--map {given}: is not a kinemap map file, expected one that --save-map wrote")
    if save is not None:
        if save.is_dir():
            raise InputError(f"--save-map {save}: is a folder, expected a file")
        if not save.parent.is_dir() or not os.access(save.parent, os.W_OK):
            raise InputError(f"--save-map {save}: expected a folder there that can be written to")
