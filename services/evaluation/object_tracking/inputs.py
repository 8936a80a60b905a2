# SPDX-License-Identifier: Apache-2.0
"""Sequences of tracked objects, each with its truth, out of two files or two folders."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from services.evaluation.object_tracking.matching import ObjectSequence
from services.evaluation.object_tracking.sequences import (
    EXPECTED,
    frame_names,
    holds_images,
    read_image_sequence,
    read_text_sequence,
)
from services.evaluation.progress import Progress, silent
from services.formats.rle import Rle
from services.runtime.errors import InputError

DEFAULT_CATEGORIES = ("car", "pedestrian")


@dataclass(frozen=True)
class SequencePair:
    """One sequence's truth and what was found in it."""

    truth: ObjectSequence
    found: ObjectSequence


def read_sequence_pairs(found: Path, truth: Path, progress: Progress = silent) -> list[SequencePair]:
    """Pair two files or folders of label images, or the sequences of two folders by name.

    Raises:
        InputError: nothing there, masks against boxes, no frame in common, a sequence that was not found, or what the
            formats refuse.
    """
    true_places, found_places = _sequences(truth), _sequences(found)
    if len(true_places) == len(found_places) == 1:
        found_places = dict(zip(true_places, found_places.values(), strict=True))
    missing = [name for name in true_places if name not in found_places]
    if missing:
        raise InputError(f"{found}: no sequence {missing[0]!r}, expected one for each of {', '.join(true_places)}")
    return [_read_pair(name, true_places[name], found_places[name]) for name in progress([*true_places], "reading")]


def known_categories(pairs: Sequence[SequencePair], names: Sequence[str] = ()) -> list[str]:
    """The categories named; without names, of car and pedestrian those that the truth has.

    Raises:
        InputError: a truth without objects, a name that it does not have, or neither car nor pedestrian; says those
            it has.
    """
    present = set[str]().union(*(pair.truth.categories for pair in pairs))
    if not present:
        names_of_all = ", ".join(pair.truth.name for pair in pairs)
        raise InputError(f"{names_of_all}: no object in the truth, expected one at least")
    having = f"expected one of {', '.join(sorted(present))}"
    for name in names:
        if name not in present:
            raise InputError(f"category {name!r}: not in the truth, {having}")
    chosen = list(names) or [name for name in DEFAULT_CATEGORIES if name in present]
    if not chosen:
        raise InputError(f"no {' and no '.join(DEFAULT_CATEGORIES)} in the truth, {having} by --category")
    return chosen


def _sequences(path: Path) -> dict[str, Path]:
    """By name: a file, a folder of label images, the text files of a folder, or its folders of label images."""
    if path.is_file():
        return {path.stem: path}
    if not path.is_dir():
        raise InputError(f"{path}: no such file or folder, expected {EXPECTED}")
    if holds_images(path):
        return {path.name: path}
    places = {file.stem: file for file in sorted(path.glob("*.txt"))}
    if not places:
        folders = {p.name: p / "instances" if (p / "instances").is_dir() else p for p in sorted(path.iterdir())}
        places = {name: folder for name, folder in folders.items() if folder.is_dir() and holds_images(folder)}
    if not places:
        raise InputError(f"{path}: no sequence, expected {EXPECTED}")
    return places


def _read_pair(name: str, truth: Path, found: Path) -> SequencePair:
    numbers = _frame_numbers(truth, found)
    sides = [
        read_image_sequence(name, place, numbers) if place.is_dir() else read_text_sequence(name, place)
        for place in (truth, found)
    ]
    kinds = {isinstance(item.shape, Rle) for side in sides for items in side.frames.values() for item in items}
    if len(kinds) > 1:
        raise InputError(f"{found} and {truth}: boxes and masks, expected two of a kind")
    return SequencePair(*sides)


def _frame_numbers(truth: Path, found: Path) -> dict[str, int]:
    """The number of each frame of image folders: its name where all are numbers, else its place in the truth."""
    names = [frame_names(place) for place in (truth, found) if place.is_dir()]
    if len(names) == 2 and not set(names[0]) & set(names[1]):
        raise InputError(
            f"{found}: no frame of the truth's, expected names such as {next(iter(names[0]), 'none')!r}; "
            f"found {next(iter(names[1]), 'none')!r}"
        )
    frames = names[0] if names else []
    numbered = all(name.isdecimal() for name in frames)
    return {name: int(name) if numbered else place for place, name in enumerate(frames)}
