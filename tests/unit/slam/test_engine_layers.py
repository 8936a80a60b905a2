# SPDX-License-Identifier: Apache-2.0
"""The engine's layers include downwards only; tracking, mapping and loop closing never meet."""

import re
from pathlib import Path

import pytest

ENGINE = Path(__file__).resolve().parents[3] / "services" / "slam" / "engine"

BELOW = {
    "files": set[str](),
    "geometry": set[str](),
    "features": {"files", "geometry"},
    "map": {"geometry", "features"},
    "ground": {"geometry", "features", "map"},
    "storage": {"files", "geometry", "features", "map"},
    "optimization": {"geometry", "features", "map"},
    "tracking": {"geometry", "features", "map", "optimization"},
    "loop_closing": {"geometry", "features", "map", "optimization"},
    "semi_dense": {"geometry", "features", "map"},
    "mapping": {"geometry", "features", "map", "optimization"},
}


def included_layers(folder: Path) -> set[str]:
    """Layers named by the includes of a folder's own sources, tests aside."""
    sources = [*folder.glob("*.h"), *folder.glob("*.cc")]
    assert sources, f"no sources in {folder}"
    includes = (re.findall(r'^#include "(\w+)/', source.read_text(), re.MULTILINE) for source in sources)
    return {layer for names in includes for layer in names}


@pytest.mark.parametrize("layer", BELOW)
def test_a_layer_includes_only_what_lies_below_it(layer: str) -> None:
    assert included_layers(ENGINE / layer) <= BELOW[layer] | {layer}


def test_every_folder_of_sources_is_a_known_layer() -> None:
    folders = {folder.name for folder in ENGINE.iterdir() if folder.is_dir()}
    assert folders == BELOW.keys() | {"bindings", "synthetic", "fuzz"}


def test_only_the_bindings_know_python() -> None:
    users = {source.parent.name for source in ENGINE.rglob("*.[hc]*") if "pybind11" in source.read_text()}
    assert users - {ENGINE.name} == {"bindings"}  # the engine's own folder holds CMakeLists.txt
