# SPDX-License-Identifier: Apache-2.0
"""What the segmenter finds on real images, against the masks beside them.

    python -m tests.benchmark.segmenter.found_on_images NAME=FOLDER... [--weights FILE] [--every 1] [--write]

Each FOLDER has images (image_2 or image_0) and `instances/`. Precision and recall of cars at IoU 0.5; cars less than 40
px high are neither missed nor wrong. `--write` puts the table into docs/measurements.md.
"""

import argparse
import tempfile
from pathlib import Path

from schemas.records import Image
from services.camera.sources.folders.image_files import ImageFiles
from services.evaluation.instance_masks.found import FoundRules, FoundScore, found_scores
from services.evaluation.instance_masks.inputs import read_mask_input
from services.formats.label_images import LabelledInstance, write_label_image, write_label_index
from services.runtime.config.segmenter import SegmenterConfig
from services.segmenter.backend import FrameContext, InstanceBackend, InstanceFilter
from services.segmenter.configured_network import configured_network
from tests.benchmark.measurements_page import markdown_table, put

CATEGORY = "car"
PRECISION_ASKED = 0.5
LEAST_SCORE = 0.05
"""low, so that the whole curve is seen"""
HEADER = ("images", "frames", "true cars", "precision, recall at score 0.3", "highest recall at precision 0.5")


def segment_folder(backend: InstanceBackend, source: Path, every: int, out: Path) -> int:
    """Write label images of every so manieth image of `source`; how many."""
    images = ImageFiles(next(source / name for name in ("image_2", "image_0") if (source / name).is_dir()))
    index = {}
    for number in range(0, len(images), every):
        name = images.name(number)
        found = backend.segment(Image(number, images.read(number)), FrameContext(name))
        write_label_image(out / f"{name}.png", found.labels)
        index[name] = [LabelledInstance(item.instance_id, item.category, item.score) for item in found.instances]
    write_label_index(out, index)
    return len(index)


def score_folder(backend: InstanceBackend, source: Path, every: int) -> tuple[int, FoundScore]:
    """Frames, and the score of their cars; frames that were left out do not count."""
    with tempfile.TemporaryDirectory() as folder:
        frames = segment_folder(backend, source, every, Path(folder))
        given = read_mask_input(Path(folder), source / "instances")
    left_out = set(given.without_result)
    numbers = {image.image_id for image in given.truth.images if image.file_name not in left_out}
    truth = type(given.truth)(
        tuple(image for image in given.truth.images if image.image_id in numbers),
        given.truth.categories,
        tuple(item for item in given.truth.annotations if item.image_id in numbers),
    )
    rules = FoundRules(minimum_iou=0.5, minimum_height_px=40.0, minimum_score=0.3)
    return frames, found_scores(truth, given.found, given.category_ids([CATEGORY]), rules)[CATEGORY]


def main() -> None:
    """Score every folder and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sources", nargs="+", metavar="NAME=FOLDER")
    parser.add_argument("--weights", help="a file or a name of `kinemap weights`; what runs by default otherwise")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--precision", default="auto")
    parser.add_argument("--write", action="store_true")
    arguments = parser.parse_args()
    settings = SegmenterConfig.model_validate(
        {"weights": arguments.weights, "precision": arguments.precision, "min_score": LEAST_SCORE}
    )
    backend = configured_network(settings, InstanceFilter(frozenset({CATEGORY}), LEAST_SCORE))
    rows = []
    for text in arguments.sources:
        name, _, folder = text.partition("=")
        frames, score = score_folder(backend, Path(folder), arguments.every)
        rows.append(
            (
                name,
                str(frames),
                str(score.true_positives + score.false_negatives),
                f"{_share(score.precision)}, {_share(score.recall)}",
                _share(score.recall_at(PRECISION_ASKED)),
            )
        )
    table = markdown_table(HEADER, rows)
    if arguments.write:
        put(
            "segmenter-real-images", "python -m tests.benchmark.segmenter.found_on_images NAME=FOLDER... --write", table
        )
    else:
        print(table)


def _share(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


if __name__ == "__main__":
    main()
