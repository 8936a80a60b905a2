# SPDX-License-Identifier: Apache-2.0
"""The rectified pair on KITTI 06: errors without any alignment of scale.

`python -m tests.benchmark.slam.kitti_stereo KITTI/sequences` puts its table into docs/measurements.md.
"""

import numpy as np

from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.slam.benchmark_passes import add_kitti_argument, parser_of, run_groups
from tests.benchmark.slam.engine_pass import EnginePass
from tests.benchmark.slam.sequence_part import SequencePart

HEADER = ("sequence", "runs", "coverage", "ATE, SE(3), median (worst)", "scale off, median (worst)", "ms p50 / p95")


def main() -> None:
    """Run it with every seed."""
    parser = parser_of(__doc__)
    add_kitti_argument(parser)
    parser.add_argument("--seeds", type=int, default=10, help="how many")
    given = parser.parse_args()
    part = SequencePart(given.kitti / "06", right_images="image_1")
    passes = [EnginePass((part,), options={"seed": seed}, name=f"seed {seed}") for seed in range(given.seeds)]
    reports = run_groups({"06": passes}, given.jobs)["06"]
    ates = [report.ate_se3_m for report in reports]
    scale_off = [abs(report.scale - 1) for report in reports]
    wall_ms = np.concatenate([report.wall_ms for report in reports])
    row = [
        "06",
        str(len(reports)),
        f"{min(report.coverage for report in reports):.1%}",
        f"{np.median(ates):.3f} m ({max(ates):.3f} m)",
        f"{np.median(scale_off):.2%} ({max(scale_off):.2%})",
        f"{np.percentile(wall_ms, 50):.0f} / {np.percentile(wall_ms, 95):.0f}",
    ]
    command = f"python -m tests.benchmark.slam.kitti_stereo KITTI/sequences --seeds {given.seeds}"
    put("slam-kitti-stereo", command, markdown_table(HEADER, [row]))


if __name__ == "__main__":
    main()
