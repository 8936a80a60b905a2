# SPDX-License-Identifier: Apache-2.0
"""Reports of finished passes in a folder, so that a benchmark of hours goes on where it was stopped."""

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from services.slam import _engine
from tests.benchmark.slam.engine_pass import EnginePass, PassReport, run_passes

POINTS = ("centers", "true_centers")
ARRAYS = ("wall_ms", "cpu_ms", "read_ms", "rss_mb", "sizes", "states")


class KeptPasses:
    """One file a pass, named by what was run and by the engine's bytes: another engine runs it again."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self._folder = folder
        self._engine = hashlib.sha256(Path(str(_engine.__file__)).read_bytes()).hexdigest()

    def find(self, given: EnginePass) -> PassReport | None:
        """The report of a pass that was run before; None when it was not."""
        file = self._file(given)
        return _read(file) if file.is_file() else None

    def keep(self, given: EnginePass, report: PassReport) -> None:
        """Write a report; a half-written one is never found."""
        unfinished = self._file(given).with_suffix(".part")
        unfinished.write_text(json.dumps(asdict(report), default=np.ndarray.tolist))
        unfinished.replace(self._file(given))

    def _file(self, given: EnginePass) -> Path:
        return self._folder / f"{hashlib.sha256(f'{given!r} {self._engine}'.encode()).hexdigest()[:24]}.json"


def _read(file: Path) -> PassReport:
    fields = json.loads(file.read_text())
    fields |= {name: np.array(fields[name]) for name in ARRAYS}
    fields |= {name: np.array(fields[name], float).reshape(-1, 3) for name in POINTS}
    fields["landmarks"] = {int(state): count for state, count in fields["landmarks"].items()}
    return PassReport(**fields)


def run_missing(given: Sequence[EnginePass], jobs: int, kept: KeptPasses | None) -> Iterator[PassReport]:
    """The reports of all passes in order; those that were kept are not run again."""
    found = [None if kept is None else kept.find(each) for each in given]
    fresh = run_passes([each for each, report in zip(given, found, strict=True) if report is None], jobs)
    for each, report in zip(given, found, strict=True):
        if report is not None:
            yield report
            continue
        newest = next(fresh)
        if kept is not None:
            kept.keep(each, newest)
        yield newest
