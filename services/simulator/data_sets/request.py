# SPDX-License-Identifier: Apache-2.0
"""What a data set is asked to be."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from typing import Any

from services.runtime.errors import InputError
from services.simulator.options import DriveOptions

FORMATS = {
    "kitti": "image_2 (image_3 in stereo), calib.txt, times.txt and poses: always written",
    "grey": "image_0 (image_1 in stereo)",
    "instances": "label images that `kinemap run` finds",
    "coco": "annotations/instances.json",
    "tracking": "label_02: KITTI's tracking labels",
    "mots": "instances_txt: MOTS",
    "flow": "flow in KITTI's PNG",
    "moving": "masks of what moves",
    "depth": "depth in 16-bit PNG",
    "surface": "labelled points of what stands",
    "tum": "trajectory.tum",
}
DEFAULT_FORMATS = frozenset(FORMATS) - {"grey"}
_MAX_SEQUENCES = 1000


@dataclass(frozen=True, slots=True)
class DataSetRequest:
    """Sequences that differ in their seeds alone, and what is written of each.

    drive: what all have in common; its own seed does not count, nor do its threads, which no byte depends on.

    Raises:
        InputError: no seed, one that stands twice, an unknown format, or a lens that KITTI's layout cannot say.
    """

    drive: DriveOptions
    seeds: tuple[int, ...]
    formats: frozenset[str] = DEFAULT_FORMATS

    def __post_init__(self) -> None:
        if not 0 < len(self.seeds) <= _MAX_SEQUENCES:
            raise InputError(f"{len(self.seeds)} seeds, expected 1 to {_MAX_SEQUENCES}")
        twice = [seed for seed in self.seeds if self.seeds.count(seed) > 1]
        if twice:
            raise InputError(f"seed {twice[0]} stands there twice, expected each once")
        if self.drive.lens != "pinhole":
            raise InputError(f"simulator lens={self.drive.lens!r}: expected 'pinhole', KITTI's layout knows no other")
        for sequence in self.sequences:
            self.drive_of(sequence)

    @property
    def sequences(self) -> tuple[str, ...]:
        """Their names, in the order of the seeds: 00, 01..."""
        return tuple(f"{number:02d}" for number in range(len(self.seeds)))

    @property
    def frame_count(self) -> int:
        """Frames of all sequences."""
        return self.drive.frames * len(self.seeds)

    def drive_of(self, sequence: str) -> DriveOptions:
        """The options of one sequence's drive."""
        return replace(self.drive, seed=self.seeds[self.sequences.index(sequence)])

    def as_json(self) -> dict[str, Any]:
        """Everything that the bytes depend on."""
        drive = asdict(self.drive)
        for name in ("seed", "threads"):
            del drive[name]
        drive["distortion"] = list(self.drive.distortion)
        return {"simulator": drive, "seeds": list(self.seeds), "formats": sorted(self.formats)}


def parse_formats(names: Iterable[str]) -> frozenset[str]:
    """The formats of these names, `kitti` among them. Raises InputError for an unknown one."""
    chosen = frozenset(names) | {"kitti"}
    unknown = sorted(chosen - set(FORMATS))
    if unknown:
        raise InputError(f"format '{unknown[0]}': expected some of {', '.join(FORMATS)}")
    return chosen


def first_difference(one: dict[str, Any], other: dict[str, Any], prefix: str = "") -> tuple[str, Any, Any] | None:
    """Where two nested options differ first: the name, and both values (None: not there)."""
    for name in [*one, *(name for name in other if name not in one)]:
        here, there = one.get(name), other.get(name)
        if isinstance(here, dict) and isinstance(there, dict):
            found = first_difference(here, there, f"{prefix}{name}.")
            if found is not None:
                return found
        elif here != there:
            return f"{prefix}{name}", here, there
    return None
