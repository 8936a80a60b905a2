# SPDX-License-Identifier: Apache-2.0
"""Milliseconds an image takes in each way to run a network, and whether all find the same.

    python -m tests.benchmark.segmenter.runtimes IMAGES [--weights FILE] [--count 8] [--write]

IMAGES is a folder of images. Without weights, those of three networks are drawn by chance and all images fitted into
852x448: the convolutions take as long as with real ones, but nothing is found, and no masks are made.
Least times of all runs; processor time of one thread, and time by the clock with two. Agreement is over instances with
a score of 0.3 and more in exact numbers: the share that has a mask of IoU 0.98 and more among the others, and the
median IoU. `--write` puts the table into docs/measurements.md.
"""

import argparse
import time
from pathlib import Path

import numpy as np
import numpy.typing as npt
import torch

from services.camera.sources.folders.image_files import ImageFiles
from services.segmenter.configured_network import inference_of
from services.segmenter.inference import TorchOptions, precisions
from services.segmenter.network_instances import Inference
from services.segmenter.networks import Network, build
from services.segmenter.solov2.folding import folded
from services.segmenter.solov2.instances import SegmentedInstances
from services.segmenter.solov2.network import SoloV2
from services.segmenter.weights.model_file import load_network
from tests.benchmark.measurements_page import markdown_table, put

HEADER = ("network", "way", "ms of CPU, one thread", "ms, two threads", "same masks (IoU 0.98)", "median IoU")
LEAST_SCORE = 0.3
SAME_IOU = 0.98
_DRAWN = ("solov2-light_r18", "solov2-compact_r18", "mask-rcnn_r50")
_DRAWN_BOX = (852, 448)
_LEAST_KEPT = 0.1

Images = list[npt.NDArray[np.uint8]]


def least_ms(inference: Inference, images: Images) -> tuple[float, float]:
    """Processor time with one thread, and time by the clock with two."""
    least = []
    for threads, clock in ((1, time.process_time), (2, time.perf_counter)):
        torch.set_num_threads(threads)
        inference.segment(images[0])
        times = []
        for image in images:
            begun = clock()
            inference.segment(image)
            times.append(clock() - begun)
        least.append(1e3 * min(times))
    return least[0], least[1]


def overlaps(exact: SegmentedInstances, other: SegmentedInstances) -> list[float]:
    """Of each sure instance the largest IoU with one of the same category."""
    one, two = (side.masks.flatten(1).float() for side in (exact, other))
    shared = one @ two.T
    iou = shared / (one.sum(1)[:, None] + two.sum(1)[None] - shared).clamp(min=1)
    iou = iou * (exact.labels[:, None] == other.labels[None])
    sure = exact.scores >= LEAST_SCORE
    return iou[sure].amax(1).tolist() if iou.shape[1] and bool(sure.any()) else [0.0] * int(sure.sum())


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
    """A row for each precision."""
    ready, device = folded(network), torch.device("cpu")
    exact: list[SegmentedInstances] = []
    rows = []
    for precision in precisions(device):
        inference = inference_of(ready, box, _LEAST_KEPT, TorchOptions(device, precision))
        cpu_ms, wall_ms = least_ms(inference, images)
        cells = ["-", "-"]
        if compared:
            found = [inference.segment(image) for image in images]
            exact = exact or found
            ious = [iou for one, other in zip(exact, found, strict=True) for iou in overlaps(one, other)]
            if ious:
                cells = [f"{np.mean(np.array(ious) >= SAME_IOU):.1%} of {len(ious)}", f"{np.median(ious):.3f}"]
        print(f"{name}, torch {precision}: {cpu_ms:.0f} ms of CPU, {wall_ms:.0f} ms with two threads", flush=True)
        rows.append((f"{name}, {box[0]}x{box[1]}", f"torch {precision}", f"{cpu_ms:.0f}", f"{wall_ms:.0f}", *cells))
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
    if arguments.write:
        put("segmenter-runtimes", "python -m tests.benchmark.segmenter.runtimes IMAGES --write", table)
    else:
        print(table)


if __name__ == "__main__":
    main()
