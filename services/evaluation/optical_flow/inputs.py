# SPDX-License-Identifier: Apache-2.0
"""Pairs of flow images, from files or folders, in KITTI's or Middlebury's format."""

from dataclasses import dataclass
from pathlib import Path

from services.formats.kitti_flow import FlowImage, read_kitti_flow
from services.formats.middlebury_flow import read_middlebury_flow
from services.runtime.errors import InputError

_READERS = {".png": read_kitti_flow, ".flo": read_middlebury_flow}
_KITTI_ALL, _KITTI_VISIBLE = "flow_occ", "flow_noc"


@dataclass(frozen=True)
class FlowPair:
    """The files of one image: what was found, the truth, and the truth of what both images see, where there is one."""

    name: str
    found: Path
    truth: Path
    visible_truth: Path | None = None


@dataclass(frozen=True)
class FlowPairs:
    """Every pair, and the names of true images that nothing was found for: they do not count."""

    pairs: tuple[FlowPair, ...]
    missing: tuple[str, ...] = ()


def find_flow_pairs(found: Path, truth: Path, visible_truth: Path | None = None) -> FlowPairs:
    """Pair two files, or the files of two folders by name.

    A folder that holds KITTI's `flow_occ` and `flow_noc` stands for both truths, that of all pixels and that of the
    pixels not occluded.

    Raises:
        InputError: nothing there, one file and one folder, or no name in common.
    """
    for path in (found, truth, *([visible_truth] if visible_truth else [])):
        if not path.exists():
            raise InputError(f"{path}: no such file or folder, expected flow as .png (KITTI) or .flo")
        if path.is_dir() != found.is_dir():
            raise InputError(f"{found} and {path}: a file and a folder, expected two of a kind")
    if not found.is_dir():
        return FlowPairs((FlowPair(found.stem, found, truth, visible_truth),))
    if visible_truth is None and (truth / _KITTI_ALL).is_dir():
        visible_truth = truth / _KITTI_VISIBLE if (truth / _KITTI_VISIBLE).is_dir() else None
        truth = truth / _KITTI_ALL
    found_files, true_files = _flow_files(found), _flow_files(truth)
    visible_files = _flow_files(visible_truth) if visible_truth else {}
    names = [name for name in true_files if name in found_files]
    if not names:
        raise InputError(
            f"{found}: no file of the truth's, expected names such as {next(iter(true_files))!r}; "
            f"found {next(iter(found_files))!r}"
        )
    pairs = tuple(FlowPair(name, found_files[name], true_files[name], visible_files.get(name)) for name in names)
    return FlowPairs(pairs, tuple(name for name in true_files if name not in found_files))


def read_flow(path: Path) -> FlowImage:
    """Read one image by the ending of its name. Raises InputError for another ending and as the formats do."""
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"{path}: ends with '{path.suffix}', expected .png (KITTI flow) or .flo (Middlebury flow)")
    return reader(path)


def _flow_files(folder: Path) -> dict[str, Path]:
    files = {path.stem: path for path in sorted(folder.iterdir()) if path.suffix.lower() in _READERS}
    if not files:
        raise InputError(f"{folder}: no flow, expected .png (KITTI) or .flo files")
    return files
