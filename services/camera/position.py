# SPDX-License-Identifier: Apache-2.0
"""How far the camera is, on disk, so that one that was killed goes on where it was."""

import json
from pathlib import Path
from typing import NamedTuple

from services.runtime.errors import ResourceError


class Position(NamedTuple):
    """The last frame done and its capture time; `ended` when the end of input is done too."""

    sequence: int = -1
    timestamp_ns: int = -1
    ended: bool = False


class PositionFile:
    """One small file, replaced as a whole. What another session left there does not count."""

    def __init__(self, path: Path, session: str) -> None:
        self._path = path
        self._session = session

    def read(self) -> Position:
        """The position that was saved last, or that before the first frame."""
        try:
            saved = json.loads(self._path.read_bytes())
            if saved["session"] == self._session:
                return Position(int(saved["sequence"]), int(saved["timestamp_ns"]), bool(saved["ended"]))
        except FileNotFoundError:
            return Position()
        except OSError as error:
            raise ResourceError(f"position file {self._path} cannot be read: {error.strerror}") from error
        except (ValueError, KeyError, TypeError) as error:
            raise ResourceError(f"position file {self._path} is damaged; remove it to start from frame 0") from error
        return Position()

    def save(self, position: Position) -> None:
        """Replace the file. Raises ResourceError when the disk does not take it."""
        part = self._path.with_suffix(".part")
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            part.write_text(json.dumps({"session": self._session, **position._asdict()}), encoding="utf-8")
            part.replace(self._path)
        except OSError as error:
            raise ResourceError(f"position file {self._path} cannot be written: {error.strerror}") from error
