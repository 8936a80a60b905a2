# SPDX-License-Identifier: Apache-2.0
"""Fixtures of every test."""

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real recordings; the test skips where there is none."""
    folder = Path(os.environ.get("KINEMAP_DATA", Path(__file__).resolve().parent.parent.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"no recordings at {folder}; set KINEMAP_DATA to a folder that holds kitti/sequences/03")
    return folder


@pytest.fixture(scope="session")
def golden_outputs() -> Path:
    """The folder of what reference implementations computed; the test skips where there is none."""
    folder = Path(os.environ.get("KINEMAP_GOLDEN", Path(__file__).resolve().parent.parent.parent / "shared" / "golden"))
    if not folder.is_dir():
        pytest.skip(f"no golden outputs at {folder}; set KINEMAP_GOLDEN to a folder that holds solov2_light_r18")
    return folder
