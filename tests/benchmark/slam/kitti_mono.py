# SPDX-License-Identifier: Apache-2.0
"""One camera on KITTI: ten seeds of the random sampling from five start frames of sequence 03, and 06's left camera.

`python -m tests.benchmark.slam.kitti_mono KITTI/sequences [--jobs 2]` puts its table into docs/measurements.md.
"""

import numpy as np

from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.benchmark_passes import add_kitti_argument, metres, parser_of, run_groups
from tests.benchmark.slam.engine_pass import EnginePass, PassReport
from tests.benchmark.slam.median_parallax import first_with_parallax
from tests.benchmark.slam.sequence_part import SequencePart

STARTS = (0, 20, 40, 60, 80)
FRAMES = 300
HEADER = (
    "sequence, start",
    "runs",
    "ATE median (worst)",
    "tracked once started, median (worst)",
    "1° of parallax at frame",
    "started at frame, median (worst)",
    "ms a frame p50 / p95",
    "peak memory",
)


def row(name: str, part: SequencePart, reports: list[PassReport]) -> list[str]:
    """A start's line of the table."""
    ates = [report.ate_m for report in reports]
    shares = [report.tracked_share for report in reports]
    starts = [report.initialized_at for report in reports]
    parallax_at = first_with_parallax(part)
    wall_ms = np.concatenate([report.wall_ms for report in reports])
    return [
        name,
        str(len(reports)),
        f"{metres(float(np.median(ates)))} ({metres(max(ates))})",
        f"{np.median(shares):.1%} ({min(shares):.1%})",
        "never" if parallax_at is None else str(parallax_at),
        f"{np.median(starts):.0f} ({max(starts)})",
        f"{np.percentile(wall_ms, 50):.0f} / {np.percentile(wall_ms, 95):.0f}",
        f"{max(report.peak_rss_mb for report in reports):.0f} MB",
    ]


def main() -> None:
    """Run all starts and seeds."""
    parser = parser_of(__doc__)
    add_kitti_argument(parser)
    parser.add_argument("--seeds", type=int, default=10, help="how many")
    given = parser.parse_args()
    parts = {f"03, {start}": SequencePart(given.kitti / "03", start, FRAMES - start) for start in STARTS}
    parts["06, 0"] = SequencePart(given.kitti / "06")
    groups = {
        name: [EnginePass((part,), options={"seed": seed}, name=f"seed {seed}") for seed in range(given.seeds)]
        for name, part in parts.items()
    }
    reports = run_groups(groups, given.jobs)
    rows = [row(name, part, reports[name]) for name, part in parts.items()]
    of_03 = [report.ate_m for name in parts if name.startswith("03") for report in reports[name]]
    rows.append(["03, all", str(len(of_03)), f"{np.median(of_03):.3f} m ({max(of_03):.3f} m)", *[""] * 5])
    command = f"python -m tests.benchmark.slam.kitti_mono KITTI/sequences --seeds {given.seeds} --jobs {given.jobs}"
    put("slam-kitti-mono", command, markdown_table(HEADER, rows))


if __name__ == "__main__":
    main()
