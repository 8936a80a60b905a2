# SPDX-License-Identifier: Apache-2.0
"""`kinemap` as a user types it."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from services.cli.app import main


class Ended(NamedTuple):
    """How a command ended."""

    code: int
    out: str
    err: str

    def is_one_line(self, *parts: str) -> None:
        """Assert that it was refused in one line that says all of `parts`."""
        assert (self.code, self.err.count("\n")) == (2, 1), self
        assert self.err.startswith("kinemap: error: "), self.err
        for part in parts:
            assert part in self.err, self.err


@pytest.fixture
def kinemap(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Callable[..., Ended]:
    """Runs `kinemap ARGUMENTS` in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("NO_COLOR", "1")

    def run(*arguments: str | Path) -> Ended:
        monkeypatch.setattr(sys, "argv", ["kinemap", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        return Ended(int(ended.value.code or 0), *capsys.readouterr())

    return run
