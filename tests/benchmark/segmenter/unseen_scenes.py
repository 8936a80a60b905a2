# SPDX-License-Identifier: Apache-2.0
"""Mask AP on simulated scenes that were never learned from.

    python -m tests.benchmark.segmenter.unseen_scenes FOLDER... [--weights FILE] [--write]

FOLDERs are of `kinemap train scenes`, of seeds that no training has seen. AP by pycocotools; instances less than 25 px
high are neither missed nor wrong, as in KITTI's object benchmark. `--write` puts the table into docs/measurements.md.
"""

import argparse

from services.cli.train.segmenter_validation import KITTI_HEIGHT_PX, Validation
from services.cli.train.training_data import parse_training_data
from services.segmenter.weights.choice import choose_model
from services.segmenter.weights.model_file import load_solov2
from tests.benchmark.measurements_page import markdown_table, put

HEADER = (
    "category",
    "true",
    "found",
    "mask AP",
    "AP50",
    "AP75",
    "small (below 32² px)",
    "medium",
    "large (above 96² px)",
)


def main() -> None:
    """Judge the network and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--weights", help="a file or a name of `kinemap weights`; what runs by default otherwise")
    parser.add_argument("--min-height", type=float, default=KITTI_HEIGHT_PX)
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    network, description = load_solov2(choose_model(arguments.weights).path)
    data = [parse_training_data(folder) for folder in arguments.folders]
    validation = Validation(data, description.categories, description.input_box, arguments.min_height)
    score = validation.precision(network)
    rows = []
    for name, side in {**score.by_category, "mean": score.mean}.items():
        values = (side.ap, side.ap50, side.ap75, side.ap_small, side.ap_medium, side.ap_large)
        numbers = ["-" if value is None else f"{value:.3f}" for value in values]
        rows.append((name, str(side.true_instances), str(side.found_instances), *numbers))
    table = markdown_table(HEADER, rows)
    if arguments.write:
        put("segmenter-unseen-scenes", "python -m tests.benchmark.segmenter.unseen_scenes FOLDER... --write", table)
    else:
        print(table)


if __name__ == "__main__":
    main()
