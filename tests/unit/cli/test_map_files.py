# SPDX-License-Identifier: Apache-2.0
"""`kinemap run --map --save-map --localize-only`: what cannot be is said before anything starts."""

from pathlib import Path
from typing import Any

import pytest

from services.cli.flags import resolve_config
from services.cli.map_files import require_map_files
from services.runtime.errors import InputError


def require(**slam: Any) -> None:
    require_map_files(resolve_config(None, None, {"slam": slam}))


def test_a_map_that_is_there_and_a_place_to_save_to_are_taken(tmp_path: Path) -> None:
    file = tmp_path / "town.kmap"
    file.write_bytes(b"KINEMAP\n...")
    require(map_file=file, save_map=file)
    require(map_file=file, localize_only=True)
    require()


def test_what_cannot_be_is_one_line_that_names_it(tmp_path: Path) -> None:
    picture = tmp_path / "town.png"
    picture.write_bytes(b"\x89PNG")
    for slam, expected in (
        ({"map_file": tmp_path / "none.kmap"}, r"--map .*none\.kmap: no such file"),
        ({"map_file": picture}, r"--map .*town\.png: is not a kinemap map file"),
        ({"save_map": tmp_path}, r"--save-map .*: is a folder"),
        ({"save_map": tmp_path / "no" / "town.kmap"}, r"--save-map .*: expected a folder there"),
    ):
        with pytest.raises(InputError, match=expected):
            require(**slam)


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        (["slam.localize_only=true"], r"--localize-only.* needs a map_file \(--map FILE\)"),
        (["slam.localize_only=true", "slam.map_file=a", "slam.save_map=b"], r"none for save_map \(--save-map\)"),
    ],
)
def test_localising_needs_a_map_and_leaves_none(settings: list[str], expected: str) -> None:
    with pytest.raises(InputError, match=expected):
        resolve_config(None, settings, {})
