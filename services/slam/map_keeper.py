# SPDX-License-Identifier: Apache-2.0
"""What of the engine is on disk, and when: map files that a user names, and checkpoints against a kill -9."""

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from schemas.records import TrackedFrame
from schemas.topics import Topic
from services.runtime.config import Config
from services.runtime.errors import ResourceError
from services.runtime.log import get_logger
from services.runtime.outbox import State
from services.runtime.service import Bundle
from services.slam.engine_adapter import SlamEngine
from services.slam.frame_journal import FrameJournal

MOST_FRAMES = 2000
"""A checkpoint comes after so many frames even where no keyframe is made."""
_NONE = -1


class MapKeeper:
    """Saves and loads the maps of one service.

    `lossless`: a checkpoint is the engine's exact state, and what came after it is in a journal; a successor loads the
    one, does the frames of the other again and is where its predecessor fell, to the last bit. `realtime`: a checkpoint
    is the maps; a successor recognises where it is in them and goes on.
    """

    def __init__(self, config: Config, inputs: Iterable[Topic]) -> None:
        self._options = config.slam
        self._session = config.run.session
        self._exact = config.delivery.mode == "lossless"
        self._inputs = tuple(inputs)
        self._log = get_logger("slam")
        self._folder: Path | None = None
        self._journal: FrameJournal | None = None
        self._checkpoint = _NONE
        self._keyframes = 0
        self._due = False
        self._frames = 0
        self._next_map_id = 0

    def keep_in(self, folder: Path) -> None:
        """Where checkpoints go; before this is known, or with `checkpoint_keyframes` 0, there are none."""
        if self._options.checkpoint_keyframes > 0:
            self._folder = folder

    def begin(self, engine: SlamEngine) -> None:
        """A new process begins: in the maps of its predecessor, or of the file that a user named.

        Raises InputError for a file that cannot be used.
        """
        if self._folder is not None and not self._exact and self._maps_file.exists():
            engine.resume_maps(self._maps_file, self._read_next_map_id())
            self._log.warning("maps_resumed", file=self._maps_file)
        elif self._options.map_file is not None:
            engine.load_maps(self._options.map_file)
            self._log.info("maps_loaded", file=self._options.map_file)

    def note_input(self, bundle: Bundle) -> None:
        """A frame comes."""
        if self._folder is None or not self._exact:
            return
        if self._journal is None:
            self._journal = FrameJournal(self._journal_file(self._checkpoint))
        self._journal.append(bundle, self._inputs)

    def prepare(self, engine: SlamEngine, frame: TrackedFrame) -> None:
        """A frame is done; when a checkpoint is due, what the background holds must be in the frame's update."""
        self._frames += 1
        self._keyframes += frame.keyframe_inserted
        most = self._options.exact_checkpoint_keyframes if self._exact else self._options.checkpoint_keyframes
        many = self._keyframes >= most or self._frames >= MOST_FRAMES
        self._due = self._folder is not None and many
        if self._due and self._exact:
            engine.settle()

    def keep(self, engine: SlamEngine, bundle: Bundle) -> None:
        """The frame's update was taken. Raises ResourceError when the disk does not take the checkpoint."""
        if self._exact:
            self._forget_before_checkpoint()
        else:
            self._note_map_ids(engine)
        if not self._due:
            return
        self._due, self._frames, self._keyframes = False, 0, 0
        if self._exact:
            self._checkpoint = bundle.envelope.sequence
            engine.checkpoint(self._state_file(self._checkpoint))
            if self._journal is not None:
                self._journal.close()
            # The new journal begins with the checkpoint's own frame: it tells of the camera.
            self._journal = FrameJournal(self._journal_file(self._checkpoint))
            self._journal.append(bundle, self._inputs)
        elif not self._options.localize_only:
            engine.save_maps(self._maps_file, in_background=True)

    def snapshot(self) -> State:
        """Which checkpoint the newest frame goes back to."""
        return {"checkpoint": np.array(self._checkpoint, dtype=np.int64)}

    @property
    def is_exact(self) -> bool:
        """Whether a successor can become what its predecessor was."""
        return self._folder is not None and self._exact

    @property
    def checkpoint(self) -> int:
        """The frame of the newest checkpoint, -1 for none."""
        return self._checkpoint

    def restore(self, state: State) -> tuple[Path | None, Iterator[Bundle]]:
        """What the predecessor's newest frame goes back to: a checkpoint, None for the beginning, and frames to redo.

        Where there is a checkpoint its own frame comes first, for the camera's sake.
        """
        self._checkpoint = int(state["checkpoint"])
        journal = FrameJournal(self._journal_file(self._checkpoint))
        frames = journal.read(self._session, int(state["sequence"]))
        return (None if self._checkpoint == _NONE else self._state_file(self._checkpoint)), frames

    def end(self, engine: SlamEngine) -> None:
        """The input is over, or somebody ends the service. Raises ResourceError when the map cannot be written."""
        if self._options.save_map is not None:
            engine.save_maps(self._options.save_map)
            self._log.info("maps_saved", file=self._options.save_map)

    def _forget_before_checkpoint(self) -> None:
        """Only now is the checkpoint of the frame before the one a successor would go back to."""
        assert self._exact
        if self._folder is None or self._frames != 1 or self._checkpoint == _NONE:
            return
        for file in self._folder.glob("engine-*.kmap"):
            if file != self._state_file(self._checkpoint):
                file.unlink(missing_ok=True)
        for file in self._folder.glob("inputs-*.bin"):
            if file != self._journal_file(self._checkpoint):
                file.unlink(missing_ok=True)

    def _note_map_ids(self, engine: SlamEngine) -> None:
        if self._folder is None or engine.next_map_id == self._next_map_id:
            return
        self._next_map_id = engine.next_map_id
        part = self._folder / "next_map_id.part"
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            part.write_text(str(self._next_map_id), encoding="ascii")
            part.replace(self._folder / "next_map_id")
        except OSError as error:
            raise ResourceError(f"state folder {self._folder} cannot be written: {error.strerror}") from error

    def _read_next_map_id(self) -> int:
        assert self._folder is not None
        return int((self._folder / "next_map_id").read_text(encoding="ascii"))

    @property
    def _maps_file(self) -> Path:
        assert self._folder is not None
        return self._folder / f"{self._session}.kmap"

    def _state_file(self, sequence: int) -> Path:
        assert self._folder is not None
        return self._folder / f"engine-{sequence}.kmap"

    def _journal_file(self, checkpoint: int) -> Path:
        assert self._folder is not None
        return self._folder / f"inputs-{checkpoint}.bin"
