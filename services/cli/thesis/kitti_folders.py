# SPDX-License-Identifier: Apache-2.0
"""Sequences of a KITTI odometry folder, by their numbers."""

from pathlib import Path

from services.runtime.errors import InputError

_IMAGES = ("image_0", "image_2")


def parse_sequences(text: str) -> tuple[str, ...]:
    """Names of a list such as `04,05,07`. Raises InputError for an empty name or one given twice."""
    names = tuple(name.strip() for name in text.split(","))
    if not all(names) or len(set(names)) < len(names) or any("/" in name for name in names):
        raise InputError(f"--sequences {text}: expected different names of sequences such as 04,05,07")
    return names


def sequence_folders(data: Path, names: tuple[str, ...], *, with_poses: bool) -> list[Path]:
    """DATA/sequences/NAME of each. Raises InputError for one without images or (`with_poses`) without true poses."""
    if not data.is_dir():
        raise InputError(f"--data {data}: no such folder, expected KITTI odometry's with sequences/ and poses/ in it")
    folders = [data / "sequences" / name for name in names]
    for name, folder in zip(names, folders, strict=True):
        if not any((folder / images).is_dir() for images in _IMAGES):
            raise InputError(f"--data {data}: no sequences/{name} with {' or '.join(_IMAGES)}, expected KITTI odometry")
        poses = data / "poses" / f"{name}.txt"
        if with_poses and not poses.is_file():
            raise InputError(f"{poses}: no such file, expected the true poses that errors are measured by")
    return folders
