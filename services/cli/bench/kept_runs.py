# SPDX-License-Identifier: Apache-2.0
"""What has been run in a benchmark's folder, so that no finished run is run again."""

import hashlib
import json
import shutil
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import services
from services.cli.bench.child_run import RunEnd
from services.cli.bench.plan import PlannedRun
from services.evaluation.bench.runs import BenchRun, measures_of
from services.runtime.errors import InputError, KinemapError

_CODE = ("*.py", "*.so", "*.sql")
_CODE_OF_NO_RUN = ("cli/", "evaluation/bench/")
_ENDING = {"fingerprint", "configuration", "failure", "wall_s", "alone", "code"}


@dataclass(frozen=True)
class KeptRuns:
    """The runs in `folder`; beside the folder of each lies, as JSON, how it ended."""

    folder: Path

    def finished(self, run: PlannedRun) -> BenchRun | None:
        """What came of the run, where it went through whole; None where it has to be run.

        Raises InputError where it went through with another configuration: that result is not to be overwritten.
        """
        ending = self._ending(run)
        if ending is None or ending["failure"]:
            return None
        if ending["fingerprint"] != run.fingerprint:
            what = ", ".join(_differences(ending["configuration"], run.configuration))
            raise InputError(f"{self.folder / run.folder}: was run with {what}; expected the same, or another --out")
        kept = self._bench_run(run, RunEnd("", ending["wall_s"]), ending["alone"])
        return None if kept.failure else kept

    def clear(self, run: PlannedRun) -> None:
        """Remove what a run that failed or was stopped has left."""
        folder = self.folder / run.folder
        if folder.is_dir():
            shutil.rmtree(folder)
        self._file(run).unlink(missing_ok=True)

    def keep(self, run: PlannedRun, end: RunEnd, alone: bool) -> BenchRun:
        """Note how the run ended; returns what came of it."""
        ending = {
            "fingerprint": run.fingerprint,
            "configuration": run.configuration,
            "failure": end.failure,
            "wall_s": end.wall_s,
            "alone": alone,
            "code": self.code,
        }
        file = self._file(run)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(json.dumps(ending, indent=2, sort_keys=True) + "\n", encoding="utf-8")
        return self._bench_run(run, end, alone)

    def made_by_other_code(self, run: PlannedRun) -> bool:
        """Whether the run that was kept is one of another state of the program."""
        ending = self._ending(run)
        return ending is not None and ending["code"] != self.code

    @cached_property
    def code(self) -> str:
        """SHA-256 of what runs are made by: neither the commands nor a benchmark's tables change a run."""
        root = Path(services.__path__[0])
        files = [path for pattern in _CODE for path in root.rglob(pattern)]
        digest = hashlib.sha256()
        for name, file in sorted((str(file.relative_to(root)), file) for file in files):
            if not name.startswith(_CODE_OF_NO_RUN):
                digest.update(name.encode() + b"\0" + file.read_bytes())
        return digest.hexdigest()

    def _bench_run(self, run: PlannedRun, end: RunEnd, alone: bool) -> BenchRun:
        from services.evaluation.run.report import read_report

        failure, measures = end.failure, None
        try:
            report = read_report(self.folder / run.folder / "report.json")
            measures = measures_of(report, alone=alone)
            failure = failure or report["failure"]
        except KinemapError as error:
            failure = failure or str(error)
        return BenchRun(
            run.input, run.variant, run.trial, str(run.folder), run.fingerprint, failure, end.wall_s, measures
        )

    def _file(self, run: PlannedRun) -> Path:
        return (self.folder / run.folder).with_name(f"{run.folder.name}.json")

    def _ending(self, run: PlannedRun) -> dict[str, Any] | None:
        try:
            ending = json.loads(self._file(run).read_text(encoding="utf-8"))
        except (FileNotFoundError, ValueError):
            return None  # whoever was killed while writing it has not finished the run either
        return ending if isinstance(ending, dict) and ending.keys() >= _ENDING else None


def _differences(before: dict[str, Any], now: dict[str, Any]) -> list[str]:
    return [
        f"{section}.{field} = {before.get(section, {}).get(field)!r} instead of {now.get(section, {}).get(field)!r}"
        for section in sorted({*before, *now})
        for field in sorted({*before.get(section, {}), *now.get(section, {})})
        if before.get(section, {}).get(field) != now.get(section, {}).get(field)
    ]
