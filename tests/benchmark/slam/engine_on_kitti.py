# SPDX-License-Identifier: Apache-2.0
"""Run the engine alone on a KITTI odometry folder with instance masks, and print what it achieves.

python -m tests.benchmark.slam.engine_on_kitti SEQUENCE [--poses FILE] [--stage moving] [--frames N]
"""

import argparse
import json
from collections import Counter
from pathlib import Path

import numpy as np

from services.evaluation.trajectory.alignment import Alignment
from services.slam import _engine
from tests.benchmark.slam.engine_run import TRACKING, EngineRun, run_kitti, true_centers_m


def report(run: EngineRun, poses: Path | None) -> dict[str, object]:
    """The run's figures."""
    stages = [result.stage_ms for result in run.results]
    figures: dict[str, object] = {
        "frames": len(run.results),
        "initialized_at": run.initialized_at(),
        "frames_with_a_pose": len(run.relative),
        "tracked_since_initialisation": round(run.tracked_share(), 4),
        "keyframes": len(run.keyframes),
        "culled": len(run.culled),
        "landmarks_by_state": dict(sorted(Counter(run.landmarks.values()).items())),
        "ms_p50": round(float(np.percentile(run.wall_ms, 50)), 1),
        "ms_p95": round(float(np.percentile(run.wall_ms, 95)), 1),
        "stage_ms_mean": {name: round(float(np.mean([stage[name] for stage in stages])), 1) for name in stages[0]},
        "digest": run.digest.hexdigest()[:16],
    }
    if poses is not None:
        truth = true_centers_m(poses)
        figures["ate_m"] = round(run.ate_m(truth), 3)
        figures["ate_se3_m"] = round(run.ate_m(truth, Alignment.SE3), 4)
        figures["scale_error"] = round(run.scale_error(truth), 5)
    return figures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sequence", type=Path)
    parser.add_argument("--poses", type=Path)
    parser.add_argument("--stage", choices=["base", "dynamic", "moving"], default="moving")
    parser.add_argument("--images", default="image_0")
    parser.add_argument("--stereo", action="store_true", help="use image_1 too")
    parser.add_argument("--frames", type=int)
    parser.add_argument("--option", action="append", default=[], metavar="NAME=NUMBER", help="of EngineOptions")
    arguments = parser.parse_args()
    options = _engine.EngineOptions()
    options.stage = getattr(_engine.Stage, arguments.stage)
    for assignment in arguments.option:
        name, value = assignment.split("=")
        setattr(options, name, type(getattr(options, name))(float(value)))
    run = run_kitti(
        arguments.sequence, options, images=arguments.images, frames=arguments.frames, stereo=arguments.stereo
    )
    print(json.dumps(report(run, arguments.poses), indent=1))
    for index, result in enumerate(run.results):
        if result.state != TRACKING:
            print(f"frame {index}: {result.reason}")


if __name__ == "__main__":
    main()
