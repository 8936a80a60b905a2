# SPDX-License-Identifier: Apache-2.0
"""Endpoint error, outliers and time of each way of computing flow, on an image pair with true flow.

    python -m tests.benchmark.motion.flow_backends FRAME1 FRAME2 TRUTH [--repeats 5] [--write]

RAFT with those public weights that `kinemap weights pull` put into the cache; and, for the time alone, with drawn ones.
One thread; processor time of one direction, the shortest of the repeats.
"""

import argparse
import time
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import torch

from services.evaluation.optical_flow.error import FlowError, endpoint_error
from services.formats.kitti_flow import FlowImage, read_kitti_flow
from services.motion.flow.algorithm import FlowAlgorithm, Pixels
from services.motion.flow.dis import PRESETS, Dis
from services.motion.flow.public_weights import PUBLIC_WEIGHTS
from services.motion.flow.raft.checkpoint import read_raft
from services.motion.flow.raft.network import Raft
from services.motion.flow.raft.variants import VARIANTS
from services.motion.flow.raft_algorithm import RaftAlgorithm
from tests.benchmark.measurements_page import markdown_table, put

HEADER = ("flow", "weights", "endpoint error, px", "median, px", "Fl", "ms of CPU")
ITERATIONS = 12


def ways() -> Iterator[tuple[str, str, FlowAlgorithm, bool]]:
    """Name, weights, the algorithm, and whether what it finds means anything."""
    for preset in PRESETS:
        for level in (0, 1):
            yield f"DIS {preset}, finest level {level}", "-", Dis(preset, level), True
    cpu = torch.device("cpu")
    for weights in PUBLIC_WEIGHTS:
        path = weights.here()
        if path is not None:
            yield weights.name, weights.file_name, RaftAlgorithm(read_raft(path), cpu, ITERATIONS), True
    for name, variant in VARIANTS.items():
        torch.manual_seed(0)
        yield name, "drawn", RaftAlgorithm(Raft(variant).eval(), cpu, ITERATIONS), False


def measured(algorithm: FlowAlgorithm, pair: tuple[Pixels, Pixels], repeats: int) -> tuple[FlowImage, float]:
    """The flow, and ms of processor time."""
    images = pair if algorithm.takes_colour else tuple(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in pair)
    start, end = (np.asarray(image, np.uint8) for image in images)
    best = np.inf
    for _ in range(repeats):
        begun = time.process_time()
        flow = algorithm.flow(start, end)
        best = min(best, time.process_time() - begun)
    return FlowImage(flow, np.ones(flow.shape[:2], np.bool_)), best * 1e3


def main() -> None:
    """Time and score each, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=Path)
    parser.add_argument("second", type=Path)
    parser.add_argument("truth", type=Path)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    torch.set_num_threads(1)
    first, second = (np.asarray(cv2.imread(str(path)), np.uint8) for path in (arguments.first, arguments.second))
    truth = read_kitti_flow(arguments.truth)
    rows = []
    for name, weights, algorithm, says_something in ways():
        flow, ms = measured(algorithm, (first, second), arguments.repeats)
        error = FlowError()
        error.add(endpoint_error(flow, truth), truth, truth.valid)
        scores = (
            (f"{error.epe_px:.2f}", f"{error.median_px:.2f}", f"{error.outliers:.1%}") if says_something else ("-",) * 3
        )
        rows.append((name, weights, *scores, f"{ms:.0f}"))
    table = markdown_table(HEADER, rows)
    if arguments.write:
        put("flow-backends", "python -m tests.benchmark.motion.flow_backends FRAME1 FRAME2 TRUTH --write", table)
    else:
        print(table)


if __name__ == "__main__":
    main()
