# SPDX-License-Identifier: Apache-2.0
"""Places known again by their words alone: `python -m tests.benchmark.slam.vocabulary_recall NAME=SPEC`.

SPEC is FOLDER@STEP: each image of a drive asks for others at least STEP images away, and those up to twice as far are
right; or FOLDER:FOLDER: image i of the one asks for image i of the other, 12 images more or less. Real images hold the
vocabulary against what it was not trained on.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from services.slam import _engine
from services.slam.vocabulary import SHIPPED_VOCABULARY
from tests.benchmark.measurements_page import markdown_table, put

Bags = list[_engine.BagOfWords]
NEAR_FRAMES = 12
"""At 8 m/s and 10 frames a second: within 10 m."""


def bags_of(folder: Path, vocabulary: _engine.Vocabulary, every: int) -> Bags:
    """The bags of a folder's images."""
    options = _engine.EngineOptions()
    bags = []
    for path in sorted(folder.glob("*.png"))[::every]:
        image = np.asarray(cv2.imread(str(path), cv2.IMREAD_GRAYSCALE), np.uint8)
        bags.append(vocabulary.describe(_engine.descriptors_of(image, options)[0]))
    return bags


def measure(queries: Bags, places: Bags, apart: int, near: int) -> tuple[float, float, float]:
    """Recall at 1 and 5, and the median of the best right image's similarity over the best wrong one's.

    Images nearer than `apart` to the asking one do not answer; those within `near` of it are right.
    """
    similarity = np.array([[query.similarity(place) for place in places] for query in queries])
    row, column = np.indices(similarity.shape)
    similarity[np.abs(row - column) < apart] = -1.0
    right = np.abs(row - column) <= near
    order = np.argsort(-similarity, axis=1, kind="stable")
    found = np.take_along_axis(right, order, axis=1)
    best_right = np.where(right, similarity, 0.0).max(axis=1)
    best_wrong = np.where(right, 0.0, similarity).max(axis=1)
    ratio = float(np.median(best_right / np.maximum(best_wrong, 1e-9)))
    return float(found[:, 0].mean()), float(found[:, :5].any(axis=1).mean()), ratio


def rows_of(specs: Sequence[str], vocabulary: _engine.Vocabulary, every: int) -> list[list[str]]:
    """A row of the table a spec."""
    rows = []
    for spec in specs:
        name, _, rest = spec.partition("=")
        if "@" in rest:
            folder, _, step = rest.rpartition("@")
            queries = places = bags_of(Path(folder), vocabulary, every)
            apart = max(int(step) // every, 1)
            at_1, at_5, ratio = measure(queries, places, apart, 2 * apart)
        else:
            first, _, second = rest.partition(":")
            queries, places = bags_of(Path(first), vocabulary, every), bags_of(Path(second), vocabulary, every)
            at_1, at_5, ratio = measure(queries, places, 0, NEAR_FRAMES // every)
        rows.append([name, str(len(queries)), f"{100 * at_1:.0f}%", f"{100 * at_5:.0f}%", f"{ratio:.2f}"])
        print(rows[-1])
    return rows


def main() -> None:
    """Run the benchmark and put its table on the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("specs", nargs="+", metavar="NAME=SPEC")
    parser.add_argument("--vocabulary", type=Path, default=SHIPPED_VOCABULARY)
    parser.add_argument("--every", type=int, default=1, help="only every so manieth image")
    parser.add_argument("--dry", action="store_true", help="print only")
    arguments = parser.parse_args()
    vocabulary = _engine.Vocabulary.load(str(arguments.vocabulary))
    rows = rows_of(arguments.specs, vocabulary, arguments.every)
    header = ["images", "count", "recall@1", "recall@5", "right / best wrong"]
    words = f"{vocabulary.word_count} words, {arguments.vocabulary.stat().st_size / 1e6:.2f} MB"
    if not arguments.dry:
        put(
            "vocabulary-recall",
            "python -m tests.benchmark.slam.vocabulary_recall",
            markdown_table(header, rows) + f"\n\n{words}",
        )


if __name__ == "__main__":
    main()
