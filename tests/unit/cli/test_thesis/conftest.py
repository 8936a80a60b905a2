# SPDX-License-Identifier: Apache-2.0
"""`kinemap` as a user types it."""

from collections.abc import Callable
from pathlib import Path

import pytest

from services.segmenter.weights import choice
from tests.command_line import Ended, run_kinemap


@pytest.fixture
def kinemap(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Callable[..., Ended]:
    """Runs `kinemap ARGUMENTS` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("NO_COLOR", "1")

    def run(*arguments: str | Path) -> Ended:
        return run_kinemap(monkeypatch, capsys, *arguments)

    return run


@pytest.fixture
def without_network(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Neither a public model in the cache nor the shipped weights."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(choice, "SHIPPED_WEIGHTS", tmp_path / "none.safetensors")
