# SPDX-License-Identifier: Apache-2.0
"""Run the engine alone on folders in KITTI's layout, real or made by `kinemap simulate`, and print what it achieves.

python -m tests.benchmark.slam.engine_on_kitti SEQUENCE [SEQUENCE ...] [--stage moving] [--start N] [--frames N]
    [--option seed=3] [--jobs 2] [--picture FILE.png]
"""

import argparse
import json
from pathlib import Path

from tests.benchmark.slam.engine_pass import EnginePass, PassReport, run_passes
from tests.benchmark.slam.sequence_part import SequencePart
from tests.benchmark.slam.trajectory_picture import draw_trajectories


def figures(report: PassReport) -> dict[str, object]:
    """What is printed of a pass."""
    return {
        "frames": report.frames,
        "initialized_at": report.initialized_at,
        "coverage": round(report.coverage, 4),
        "tracked_since_initialisation": round(report.tracked_share, 4),
        "ate_m": round(report.ate_m, 3),
        "ate_se3_m": round(report.ate_se3_m, 3),
        "online_ate_m": round(report.online_ate_m, 3),
        "metres_per_unit": round(report.scale, 4),
        "maps": report.maps,
        "keyframes": report.keyframes,
        "culled": report.culled,
        "landmarks_by_state": report.landmarks,
        "ms_p50": round(report.ms(50), 1),
        "ms_p95": round(report.ms(95), 1),
        "stage_ms_mean": report.stage_ms,
        "peak_rss_mb": round(report.peak_rss_mb),
        "digest": report.digest,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequences", type=Path, nargs="+")
    parser.add_argument("--stage", action="append", choices=["base", "dynamic", "moving"])
    parser.add_argument("--images", default="image_0")
    parser.add_argument("--right", help="folder of the other images of a rectified pair, such as image_1")
    parser.add_argument("--start", type=int, default=0)
    parser.add_argument("--frames", type=int)
    parser.add_argument("--option", action="append", default=[], metavar="NAME=NUMBER", help="of EngineOptions")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--picture", type=Path, help="PNG of the trajectories beside the truth")
    parser.add_argument("--brief", action="store_true", help="one line a pass")
    given = parser.parse_args()
    options: dict[str, float | str] = {
        name: float(value) for name, value in (assignment.split("=") for assignment in given.option)
    }
    passes = []
    for sequence in given.sequences:
        part = SequencePart(sequence, given.start, given.frames, images=given.images, right_images=given.right)
        name = f"{sequence.resolve().parent.parent.name}/{sequence.name}"
        passes += [EnginePass((part,), stage, options, f"{name} {stage}") for stage in given.stage or ["moving"]]
    reports = []
    for report in run_passes(passes, given.jobs):
        reports.append(report)
        if given.brief:
            print(report.name, json.dumps(figures(report)), flush=True)
            continue
        print(report.name, json.dumps(figures(report), indent=1))
        for index, reason in enumerate(report.reasons):
            if reason:
                print(f"frame {index}: {reason}")
    if given.picture is not None:
        draw_trajectories(reports, given.picture)


if __name__ == "__main__":
    main()
