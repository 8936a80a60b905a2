# SPDX-License-Identifier: Apache-2.0
"""Does ORB behave as on real images: `python -m tests.benchmark.simulator.orb_features`.

OpenCV's ORB with its default settings and 2,000 features wanted, on 1242x375. Matches between neighbouring frames in
which nothing moves are mutual nearest neighbours by Hamming distance (OpenCV's cross-check, no ratio test); one is
right where it agrees with the true flow within 3 px.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from services.simulator.drive import Drive
from services.simulator.options import DriveOptions
from tests.benchmark.measurements_page import markdown_table, put

_WANTED = 2000
_AGREES_PX = 3.0
_SEEDS = (1, 2, 3, 4)
_INDICES = (20, 80, 140, 200)
_MOVERS = "oncoming_cars", "leading_cars", "crossing_cars", "starting_cars", "walking_people", "crossing_people"
WORLDS: dict[str, dict[str, Any]] = {"street": dict.fromkeys(_MOVERS, 0), "town": {"world": "town", "traffic": 0.0}}


@dataclass(frozen=True)
class OrbBehaviour:
    """Features found in a frame; matches with the next frame; share of matches that agree with the true flow."""

    features: int
    matches: int
    right: float


def orb_features(image: NDArray[np.uint8]) -> tuple[NDArray[np.float32], NDArray[np.uint8]]:
    """Positions (N, 2) and descriptors (N, 32)."""
    points, descriptors = cv2.ORB_create(nfeatures=_WANTED).detectAndCompute(
        cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), None
    )
    return np.array([point.pt for point in points], np.float32).reshape(-1, 2), descriptors


def orb_behaviour(drive: Drive, index: int) -> OrbBehaviour:
    """ORB on frame `index` and the next one."""
    (here, ours), (there, theirs) = (orb_features(drive.render(i).image) for i in (index, index + 1))
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(ours, theirs)
    pairs = np.array([[match.queryIdx, match.trainIdx] for match in matches])
    flow = drive.flow(index)
    start, end = here[pairs[:, 0]], there[pairs[:, 1]]
    column, row = np.rint(start).astype(int).T
    off = np.linalg.norm(end - start - flow.flow_px[row, column], axis=1)
    return OrbBehaviour(len(here), len(pairs), float((off < _AGREES_PX).mean()))


def main() -> None:
    """Measure all worlds and seeds."""
    rows = []
    for world, options in WORLDS.items():
        for seed in _SEEDS:
            drive = Drive(DriveOptions(width=1242, height=375, threads=0, seed=seed, **options))
            found = [orb_behaviour(drive, index) for index in _INDICES]
            features, right = [one.features for one in found], [100.0 * one.right for one in found]
            rows.append(
                [
                    world,
                    str(seed),
                    f"{min(features)} to {max(features)}",
                    f"{np.median([one.matches for one in found]):.0f}",
                    f"{np.median(right):.0f} % (worst {min(right):.0f} %)",
                ]
            )
            print(rows[-1], flush=True)
    header = ["World", "Seed", "Features of 2,000", "Mutual matches", "Agree with true flow"]
    put("simulator-orb", "python -m tests.benchmark.simulator.orb_features", markdown_table(header, rows))


if __name__ == "__main__":
    main()
