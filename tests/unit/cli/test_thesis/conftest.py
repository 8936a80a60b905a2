# SPDX-License-Identifier: Apache-2.0
"""`kinemap` as a user types it."""

from collections.abc import Callable
from pathlib import Path

import pytest

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
