# SPDX-License-Identifier: Apache-2.0
"""bench.json: every run of a benchmark with its numbers."""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from services.evaluation.bench.runs import BenchRun, RunMeasures
from services.runtime.errors import InputError

BENCH_NAME = "bench.json"
BENCH_VERSION = 1


@dataclass(frozen=True)
class Bench:
    """What was asked for, and the runs there are of it; `planned` counts those there will be."""

    command: str
    label: str = ""
    machine: str = ""
    planned: int = 0
    runs: Sequence[BenchRun] = field(default_factory=tuple)


def write_bench(bench: Bench, folder: Path) -> None:
    """Write bench.json with sorted keys; whoever reads it meanwhile sees the old one or the new one."""
    rows = [{**asdict(run), "status": run.status.value} for run in bench.runs]
    value = {"version": BENCH_VERSION, **asdict(bench), "runs": rows}
    unfinished = folder / f".{BENCH_NAME}"
    unfinished.write_text(json.dumps(value, indent=2, sort_keys=True) + "\n", encoding="utf-8")
    unfinished.replace(folder / BENCH_NAME)


def read_bench(folder: Path) -> Bench:
    """Read it back. Raises InputError for one that is missing, no bench.json, or of another version."""
    path = folder / BENCH_NAME
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file, expected the folder of a `kinemap bench`") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a benchmark's file ({error})") from None
    version = value.pop("version", None) if isinstance(value, dict) else None
    if version != BENCH_VERSION:
        raise InputError(f"{path}: benchmark of version {version}, expected {BENCH_VERSION}")
    try:
        return Bench(**{**value, "runs": tuple(_run(row) for row in value["runs"])})
    except (TypeError, KeyError, AttributeError) as error:
        raise InputError(f"{path}: not a benchmark's file ({error})") from None


def _run(row: dict[str, object]) -> BenchRun:
    fields = {name: value for name, value in row.items() if name not in ("status", "measures")}
    measures = row["measures"]
    return BenchRun(**fields, measures=RunMeasures(**measures) if isinstance(measures, dict) else None)  # type: ignore[arg-type]
