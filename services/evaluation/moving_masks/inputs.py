# SPDX-License-Identifier: Apache-2.0
"""Moving masks out of folders: of three classes, of two (DAVIS), or label images that say which instance moves."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.evaluation.moving_masks.iou import MaskClass
from services.evaluation.progress import Progress, silent
from services.formats.label_images import INDEX_NAME, LabelledInstance, read_label_image, read_label_index
from services.runtime.errors import InputError

_BINARY_MOVING = 255


@dataclass(frozen=True)
class MovingFrame:
    """One frame's mask of `MaskClass` (H, W), and where it comes from one, its label image and instances."""

    mask: npt.NDArray[np.uint8]
    labels: npt.NDArray[np.uint16] | None = None
    instances: tuple[LabelledInstance, ...] = ()


class MovingMaskFolder:
    """Reads a folder of masks frame by frame.

    Masks are PNG files of one channel: 0 background, 1 non-moving, 2 moving; or 0 and 255, moving; or, where there is
    an `instances.json`, label images whose instances say `"moving": true` or `false`.

    Raises:
        InputError: no folder, no masks in it, or instances that do not say whether they move.
    """

    def __init__(self, path: Path) -> None:
        if not path.is_dir():
            raise InputError(f"{path}: no such folder, expected one of masks (PNG)")
        self.path = path
        self._seen: set[int] = set()
        self._index = read_label_index(path) if (path / INDEX_NAME).is_file() else None
        for frame, rows in (self._index or {}).items():
            for row in rows:
                if row.moving is None:
                    place = f"{path / INDEX_NAME} frame {frame}: instance {row.label}"
                    raise InputError(f'{place} does not say whether it moves, expected "moving": true or false')
        self.frames = sorted(file.stem for file in path.glob("*.png")) if self._index is None else sorted(self._index)
        if not self.frames:
            raise InputError(f"{path}: no masks, expected PNG files")

    @property
    def has_instances(self) -> bool:
        """Whether the moving flag of every instance is known."""
        return self._index is not None

    def read(self, frame: str) -> MovingFrame:
        """One frame. Raises InputError for pixels that are none of a mask's."""
        path = self.path / f"{frame}.png"
        pixels = read_label_image(path)
        if self._index is None:
            return MovingFrame(self._as_classes(path, pixels))
        mask = np.zeros(pixels.shape, dtype=np.uint8)
        for row in self._index[frame]:
            mask[pixels == row.label] = MaskClass.MOVING if row.moving else MaskClass.NON_MOVING
        return MovingFrame(mask, pixels, self._index[frame])

    @property
    def is_binary(self) -> bool:
        """Whether the masks read so far know moving and everything else alone."""
        return _BINARY_MOVING in self._seen

    def _as_classes(self, path: Path, pixels: npt.NDArray[np.uint16]) -> npt.NDArray[np.uint8]:
        values = {int(value) for value in np.unique(pixels)}
        self._seen |= values
        if self._seen - set(MaskClass) - {_BINARY_MOVING} or (self.is_binary and self._seen - {0, _BINARY_MOVING}):
            raise InputError(
                f"{path}: pixels of {', '.join(str(value) for value in sorted(values)[-4:])}, expected 0 (background), "
                f"1 (non-moving) and 2 (moving) in all masks of the folder, or 0 and {_BINARY_MOVING} (moving) in all"
            )
        return np.where(pixels == _BINARY_MOVING, MaskClass.MOVING, pixels).astype(np.uint8)


def paired_frames(truth: MovingMaskFolder, found: MovingMaskFolder) -> tuple[list[str], tuple[str, ...]]:
    """The truth's frames and, of these, those that the found folder has no mask of: nothing moves there.

    Raises:
        InputError: no frame in common.
    """
    missing = tuple(sorted(set(truth.frames) - set(found.frames)))
    if len(missing) == len(truth.frames):
        raise InputError(
            f"{found.path}: no frame of the truth's, expected names such as {truth.frames[0]!r}; "
            f"found {found.frames[0]!r}"
        )
    return truth.frames, missing


def read_pairs(
    truth: MovingMaskFolder, found: MovingMaskFolder, frames: Sequence[str], progress: Progress = silent
) -> Iterator[tuple[str, MovingFrame, MovingFrame]]:
    """Each frame's true and found masks; one that is not found is all background."""
    present = set(found.frames)
    for frame in progress(frames, "comparing masks"):
        true = truth.read(frame)
        nothing = MovingFrame(np.zeros_like(true.mask), None if true.labels is None else np.zeros_like(true.labels))
        yield frame, true, found.read(frame) if frame in present else nothing
