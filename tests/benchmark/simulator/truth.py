# SPDX-License-Identifier: Apache-2.0
"""Is truth true: `python -m tests.benchmark.simulator.truth`.

Warps images into one another by true flow, by true depth and pose, and left into right by true depth, and puts the
medians of the grey levels' differences into docs/measurements.md. What is judged: see `warp_errors`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from services.simulator.drive import Drive
from services.simulator.options import DriveOptions
from tests.benchmark.measurements_page import markdown_table, put
from tests.benchmark.simulator.warp_errors import stereo_error, warp_errors

_SEEDS = (1, 2, 3)
_INDICES = (10, 50, 90, 130, 170, 210)
_CASES: dict[str, dict[str, Any]] = {
    "street": {},
    "street, 1242x375": {"width": 1242, "height": 375},
    "town": {"world": "town"},
    "town, 1242x375": {"world": "town", "width": 1242, "height": 375},
    "town, low sun with shadows": {"world": "town", "light": "low_sun", "shadows": True},
    "street, radial lens": {"lens": "radial", "distortion": (-0.25, 0.06, 0.001, -0.001, 0.0)},
    "town, fisheye": {
        "world": "town",
        "lens": "fisheye",
        "distortion": (0.02, -0.01, 0.003, -0.0005),
        "fx_px": 240.0,
    },
}


def main() -> None:
    """Measure every case over all seeds."""
    rows = []
    for name, options in _CASES.items():
        moved, stereo = [], []
        for seed in _SEEDS:
            drive = Drive(DriveOptions(seed=seed, threads=0, stereo_baseline_m=0.5, **options))
            moved += [warp_errors(drive, index) for index in _INDICES]
            stereo += [stereo_error(drive, index) for index in _INDICES]
        flow, pose = [errors.by_flow for errors in moved], [errors.by_depth_and_pose for errors in moved]
        unmoved = float(np.median([errors.unmoved for errors in moved]))
        rows.append([name, *(_spread(values) for values in (flow, pose, stereo)), f"{unmoved:.1f}"])
        print(rows[-1], flush=True)
    header = ["Drive", "by flow", "by depth and pose", "right into left by depth", "without warping"]
    put("simulator-truth", "python -m tests.benchmark.simulator.truth", markdown_table(header, rows))


def _spread(values: list[float]) -> str:
    return f"{np.median(values):.2f} (worst frame {max(values):.2f})"


if __name__ == "__main__":
    main()
