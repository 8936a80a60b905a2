# SPDX-License-Identifier: Apache-2.0
"""The three stages side by side through the whole pipeline, into docs/measurements.md.

    python -m tests.benchmark.pipeline.stages NAME INPUT [--frames N] [--stages moving dynamic base]

NAME is the table's name on the page (stages-simulator, stages-kitti-03).
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from tests.benchmark.measurements_page import markdown_table, put

HEADER = (
    "stage",
    "frames tracked",
    "initialised at",
    "ATE RMSE, Sim(3)",
    "ATE RMSE, SE(3)",
    "landmarks static / standing / moving",
    "moving flag precision / recall",
    "density unknown / low / high",
    "frames/s",
)


def drive(source: str, stage: str, frames: int | None, out: Path) -> dict[str, Any]:
    """One run's report."""
    command = [sys.executable, "-m", "services.cli.app", "run", source, "--stage", stage, "--out", str(out)]
    subprocess.run([*command, *(["--frames", str(frames)] if frames else []), "--port", "0"], check=True)
    report: dict[str, Any] = json.loads((out / "report.json").read_text(encoding="utf-8"))
    return report


def row(stage: str, report: dict[str, Any]) -> list[str]:
    """A report in one line."""
    frames, landmarks, flag = report["frames"], report["landmarks"], report["moving_flag"]
    ate = report["ate"] or {}
    standing = landmarks["non_moving"] + landmarks["potentially_dynamic"] + landmarks["undecided"]
    levels = report["density_frames"]
    metric = ate.get("final_metric")
    return [
        stage,
        f"{frames['tracked']} of {frames['in']}",
        str(frames["initialized_at"]),
        f"{ate['final']['ate_m']['rmse']:.3f} m" if ate else "no truth",
        f"{metric['ate_m']['rmse']:.3f} m" if metric else "no metres",
        f"{landmarks['static']} / {standing} / {landmarks['moving']}",
        f"{flag['precision']:.3f} / {flag['recall']:.3f}" if flag else "no truth",
        f"{levels['unknown']} / {levels['low']} / {levels['high']}",
        f"{report['frames_per_s']:.1f}",
    ]


def main() -> None:
    """Drive every stage, then write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name")
    parser.add_argument("source")
    parser.add_argument("--frames", type=int)
    parser.add_argument("--stages", nargs="+", default=["moving", "dynamic", "base"])
    arguments = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for stage in arguments.stages:
            rows.append(row(stage, drive(arguments.source, stage, arguments.frames, Path(folder) / stage)))
    command = f"python -m tests.benchmark.pipeline.stages {arguments.name} {Path(arguments.source).name}"
    put(arguments.name, command, markdown_table(HEADER, rows))


if __name__ == "__main__":
    main()
