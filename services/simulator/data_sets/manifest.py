# SPDX-License-Identifier: Apache-2.0
"""dataset.json: what a data set was made of, by which it is known again and gone on with."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from services.formats.json_file import read_json, shortened
from services.runtime.errors import InputError
from services.simulator.data_sets.layout import CHECKSUMS, MANIFEST
from services.simulator.data_sets.request import DataSetRequest, first_difference
from services.simulator.data_sets.whole_file import WrittenFile, write_whole

_VERSION = 1
_EXPECTED = "the manifest of a data set that kinemap simulate made"


@dataclass(frozen=True, slots=True)
class Manifest:
    """Options of a data set, and, when it is complete, its sequences and the SHA-256 of SHA256SUMS."""

    options: Mapping[str, Any]
    complete: bool = False
    sequences: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[str, Any] = field(default_factory=dict)


def options_of(request: DataSetRequest) -> dict[str, Any]:
    """What must be equal for two data sets to be one: layout, kinemap's version, everything asked for."""
    return {"layout": _VERSION, "kinemap": importlib.metadata.version("kinemap"), **request.as_json()}


def write_manifest(root: Path, manifest: Manifest) -> None:
    """Write dataset.json, indented for people. Raises ResourceError where the disk does not take it."""
    write_whole(root, MANIFEST, lambda path: path.write_text(_as_text(manifest), encoding="utf-8"))


def read_manifest(root: Path) -> Manifest:
    """Read dataset.json. Raises InputError for what is none."""
    path = root / MANIFEST
    row = read_json(path, _EXPECTED)
    match row:
        case {"options": dict(), "complete": bool(), "sequences": dict(), "files": dict()}:
            return Manifest(row["options"], row["complete"], row["sequences"], row["files"])
    raise InputError(f"{path}: {shortened(row)}, expected {_EXPECTED}")


def require_same_options(root: Path, manifest: Manifest, request: DataSetRequest) -> None:
    """Raise InputError, naming the first option that differs, unless `request` is what the data set was made of."""
    found = first_difference(dict(manifest.options), options_of(request))
    if found is not None:
        name, there, asked = found
        raise InputError(
            f"{root}: was made with {name}={_shown(there)}, asked for is {_shown(asked)};"
            " expected the same options or another --out"
        )


def write_checksums(root: Path, files: Sequence[WrittenFile]) -> dict[str, Any]:
    """Write SHA256SUMS, by name, as sha256sum checks it; what dataset.json says of the files."""
    rows = "".join(f"{file.sha256}  {file.name}\n" for file in sorted(files, key=lambda file: file.name))
    write_whole(root, CHECKSUMS, lambda path: path.write_text(rows, encoding="ascii"))
    size = sum(file.size_bytes for file in files)
    return {"count": len(files), "bytes": size, "sha256": hashlib.sha256(rows.encode("ascii")).hexdigest()}


def missing_files(root: Path) -> list[str]:
    """Names in SHA256SUMS that are not there, itself included."""
    path = root / CHECKSUMS
    if not path.is_file():
        return [CHECKSUMS]
    names = [line.split("  ", 1)[1] for line in path.read_text(encoding="ascii").splitlines()]
    return [name for name in names if not (root / name).is_file()]


def _shown(value: object) -> str:
    return ",".join(map(str, value)) if isinstance(value, list) else shortened(value)


def _as_text(manifest: Manifest) -> str:
    row = {
        "options": manifest.options,
        "complete": manifest.complete,
        "sequences": manifest.sequences,
        "files": manifest.files,
    }
    return json.dumps(row, indent=2) + "\n"
