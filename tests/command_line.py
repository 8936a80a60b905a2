# SPDX-License-Identifier: Apache-2.0
"""`kinemap` as a user types it, run in the test's own process."""

import sys
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


def run_kinemap(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> Ended:
    """Run `kinemap ARGUMENTS` to its end."""
    monkeypatch.setattr(sys, "argv", ["kinemap", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    return Ended(int(ended.value.code or 0), *capsys.readouterr())
