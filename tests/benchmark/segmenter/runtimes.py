# SPDX-License-Identifier: Apache-2.0
"""Milliseconds an image takes in each way to run a network, and whether all find the same.

    OMP_WAIT_POLICY=passive python -m tests.benchmark.segmenter.runtimes IMAGES [--weights FILE] [--count 8] [--write]

Threads of torch that wait for each other keep the processor busy unless they are told to sleep, as the services' are.
IMAGES is a folder of images. Without weights, those of three networks are drawn by chance and all images fitted into
852x448: the convolutions take as long as with real ones, but nothing is found, and no masks are made.
Least times of all images: processor time, and time by the clock, which says something on an idle machine only.
Agreement is over the surest instances: the share that has a mask of IoU 0.98 and more among those that are found the
other way, the median and the least IoU. `--write` puts the table into docs/measurements.md.
"""

import argparse
import time
from pathlib import Path

import numpy as np
import numpy.typing as npt
import torch

from services.camera.sources.folders.image_files import ImageFiles
from services.segmenter.agreement import LEAST_KEPT, overlaps
from services.segmenter.measured_ways import SAME_IOU
from services.segmenter.network_instances import Inference
from services.segmenter.network_runs import NetworkRuns
from services.segmenter.networks import Network, build
from services.segmenter.solov2.folding import folded
from services.segmenter.solov2.instances import SegmentedInstances
from services.segmenter.solov2.network import SoloV2
from services.segmenter.weights.model_file import load_network
from tests.benchmark.measurements_page import markdown_table, put

HEADER = (
    "network",
    "way",
    "ms of CPU, one thread",
    "times torch fp32",
    "ms of CPU, two threads",
    "ms by the clock, two threads",
    "same masks (IoU 0.98)",
    "median IoU (least)",
)
_DRAWN = ("solov2-light_r18", "solov2-compact_lite0", "mask-rcnn_r50")
_COMMAND = "OMP_WAIT_POLICY=passive python -m tests.benchmark.segmenter.runtimes"
_DRAWN_BOX = (852, 448)

Images = list[npt.NDArray[np.uint8]]


def milliseconds(inference: Inference, images: Images) -> tuple[float, float]:
    """The least processor time and the least time by the clock of an image, after one to warm up."""
    inference.segment(images[0])
    cpu_s, wall_s = [], []
    for image in images:
        begun = time.process_time(), time.perf_counter()
        inference.segment(image)
        cpu_s.append(time.process_time() - begun[0])
        wall_s.append(time.perf_counter() - begun[1])
    return 1e3 * min(cpu_s), 1e3 * min(wall_s)


def drawn(name: str) -> Network:
    """A network that has learned nothing and is sure of nothing."""
    torch.manual_seed(0)
    network = build(name, 80).eval()
    if isinstance(network, SoloV2):
        # sure of everything, it would make a mask of every cell for each category
        torch.nn.init.constant_(network.mask_head.conv_cls.bias, -4.6)
    return network


def measured(
    name: str, network: Network, box: tuple[int, int], images: Images, *, compared: bool
) -> list[tuple[str, ...]]:
    """A row for each way to run it that is there."""
    ready = folded(network)
    one, two = (NetworkRuns(ready, box, torch.device("cpu"), threads) for threads in (1, 2))
    exact: list[SegmentedInstances] = []
    rows: list[tuple[str, ...]] = []
    first_ms = 0.0
    for way in one.ways:
        torch.set_num_threads(1)
        one_ms, _ = milliseconds(one.inference(way, LEAST_KEPT), images)
        torch.set_num_threads(2)
        inference = two.inference(way, LEAST_KEPT)
        two_ms, wall_ms = milliseconds(inference, images)
        first_ms = first_ms or one_ms
        cells = ["-", "-"]
        if compared:
            found = [inference.segment(image) for image in images]
            exact = exact or found
            ious = [iou for one_image, other in zip(exact, found, strict=True) for iou in overlaps(one_image, other)]
            if ious:
                cells = [
                    f"{np.mean(np.array(ious) >= SAME_IOU):.1%} of {len(ious)}",
                    f"{np.median(ious):.3f} ({min(ious):.3f})",
                ]
        times = (f"{one_ms:.0f}", f"{first_ms / one_ms:.2f}", f"{two_ms:.0f}", f"{wall_ms:.0f}")
        rows.append((f"{name}, {box[0]}x{box[1]}", str(way), *times, *cells))
        print(*rows[-1], sep=" | ", flush=True)
    return rows


def main() -> None:
    """Measure every way and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("images", type=Path)
    parser.add_argument("--weights", type=Path)
    parser.add_argument("--count", type=int, default=8)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    files = ImageFiles(arguments.images)
    places = np.linspace(0, len(files) - 1, min(arguments.count, len(files))).round().astype(int)
    images = [files.read(int(place)) for place in places]
    rows = []
    if arguments.weights is None:
        for name in _DRAWN:
            rows += measured(name, drawn(name), _DRAWN_BOX, images, compared=False)
    else:
        network, description = load_network(arguments.weights)
        rows += measured(description.variant, network, description.input_box, images, compared=True)
    table = markdown_table(HEADER, rows)
    if not arguments.write:
        print(table)
    elif arguments.weights is None:
        put("segmenter-runtimes", f"{_COMMAND} IMAGES --write", table)
    else:
        put("segmenter-runtimes-masks", f"{_COMMAND} IMAGES --weights FILE --write", table)


if __name__ == "__main__":
    main()
