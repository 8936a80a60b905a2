# SPDX-License-Identifier: Apache-2.0
"""Against pycocotools itself, on files as its own readers take them, and against a computation of the test's own."""

import contextlib
import io
from pathlib import Path

import numpy as np
import pytest
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

from services.evaluation.instance_masks.average_precision import mask_precision
from services.evaluation.instance_masks.confusion import class_confusion
from services.evaluation.instance_masks.found import FoundRules, found_scores
from services.formats.coco import (
    CocoAnnotation,
    CocoCategory,
    CocoDataset,
    CocoImage,
    CocoResult,
    read_coco,
    read_coco_results,
    write_coco,
    write_coco_results,
)
from services.formats.rle import decode_mask, encode_mask
from services.runtime.errors import InputError

HEIGHT, WIDTH = 150, 200
CAR, PERSON, BUS = 3, 1, 6


def _box_mask(x: int, y: int, width: int, height: int) -> np.ndarray:
    mask = np.zeros((HEIGHT, WIDTH), dtype=bool)
    mask[max(y, 0) : y + height, max(x, 0) : x + width] = True
    return mask


def _scene(seed: int, images: int = 12) -> tuple[CocoDataset, list[CocoResult]]:
    """Boxes of all sizes, found shifted, missed, invented, called another class; a crowd; images without truth."""
    random = np.random.default_rng(seed)
    annotations, results = [], []
    for image_id in range(1, images + 1):
        for _ in range(0 if image_id % 5 == 0 else int(random.integers(1, 6))):
            x, y = int(random.integers(0, 120)), int(random.integers(0, 90))
            width, height = (int(value) for value in random.integers(8, 110, 2))
            category = int(random.choice([CAR, PERSON]))
            mask = encode_mask(_box_mask(x, y, width, height))
            annotations.append(CocoAnnotation.of_mask(len(annotations) + 1, image_id, category, mask))
            if random.random() < 0.8:
                dx, dy = (int(value) for value in random.integers(-8, 9, 2))
                found = encode_mask(_box_mask(x + dx, y + dy, width, height))
                category = category if random.random() < 0.9 else BUS
                results.append(CocoResult(image_id, category, found, round(float(random.random()), 2)))
        if random.random() < 0.5:
            invented = encode_mask(_box_mask(*(int(value) for value in random.integers(5, 60, 4))))
            results.append(CocoResult(image_id, CAR, invented, round(float(random.random()), 2)))
    crowd = encode_mask(_box_mask(0, 0, 90, 90))
    annotations.append(CocoAnnotation(len(annotations) + 1, 5, CAR, crowd, 8100.0, (0.0, 0.0, 90.0, 90.0), True))
    categories = (CocoCategory(PERSON, "person"), CocoCategory(CAR, "car"), CocoCategory(BUS, "bus"))
    image_rows = tuple(CocoImage(number, f"{number:06d}.png", WIDTH, HEIGHT) for number in range(1, images + 1))
    return CocoDataset(image_rows, categories, tuple(annotations)), results


def _reference(folder: Path, category_ids: list[int], ious: np.ndarray | None = None) -> COCOeval:
    with contextlib.redirect_stdout(io.StringIO()):
        truth = COCO(str(folder / "truth.json"))
        evaluator = COCOeval(truth, truth.loadRes(str(folder / "found.json")), "segm")
        evaluator.params.catIds = category_ids
        if ious is not None:
            evaluator.params.iouThrs = ious
        evaluator.evaluate()
        evaluator.accumulate()
        if ious is None:
            evaluator.summarize()
    return evaluator


@pytest.fixture(params=[0, 1, 2])
def written(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    truth, found = _scene(request.param)
    write_coco(tmp_path / "truth.json", truth)
    write_coco_results(tmp_path / "found.json", found)
    return tmp_path


def test_average_precision_is_pycocotools(written: Path) -> None:
    truth = read_coco(written / "truth.json")
    found = read_coco_results(written / "found.json", truth)
    score = mask_precision(truth, found, [PERSON, CAR])
    stats = _reference(written, [PERSON, CAR]).stats
    mean = score.mean
    ours = [mean.ap, mean.ap50, mean.ap75, mean.ap_small, mean.ap_medium, mean.ap_large, mean.recall]
    ours = [-1.0 if value is None else value for value in ours]  # as pycocotools says that there is no such truth
    np.testing.assert_allclose(ours, [*stats[:6], stats[8]], atol=1e-6)
    assert 0.02 < stats[0] < 0.9
    for name, number in (("person", PERSON), ("car", CAR)):
        alone = score.by_category[name]
        np.testing.assert_allclose([alone.ap, alone.ap50], _reference(written, [number]).stats[:2], atol=1e-6)


def _own_average_precision(truth: CocoDataset, found: list[CocoResult], category: int, threshold: float) -> float:
    """AP at one IoU from pixels alone: surest first, best free mask, 101 points of the falling envelope."""
    free: dict[int, list[np.ndarray]] = {image.image_id: [] for image in truth.images}
    for annotation in truth.annotations:
        if annotation.category_id == category and not annotation.is_crowd:
            free[annotation.image_id].append(decode_mask(annotation.mask))
    total = sum(len(masks) for masks in free.values())
    right = []
    for result in sorted((r for r in found if r.category_id == category), key=lambda r: (-r.score, r.image_id)):
        mask = decode_mask(result.mask)
        overlaps = [float((mask & other).sum() / (mask | other).sum()) for other in free[result.image_id]]
        best = int(np.argmax(overlaps)) if overlaps else -1
        hit = best >= 0 and (overlaps[best] > threshold or overlaps[best] == 1.0)
        right.append(hit)
        if hit:
            free[result.image_id].pop(best)
    hits = np.cumsum(right)
    precision, recall = hits / np.arange(1, len(right) + 1), hits / total
    envelope = [precision[recall >= level].max(initial=0.0) for level in np.linspace(0, 1, 101)]
    return float(np.mean(envelope))


def test_the_thesis_average_is_that_over_eleven_thresholds() -> None:
    truth, found = _scene(4)
    truth = CocoDataset(truth.images, truth.categories, tuple(a for a in truth.annotations if not a.is_crowd))
    ious = np.arange(11) / 10
    for name, category in (("person", PERSON), ("car", CAR)):
        expected = [_own_average_precision(truth, found, category, iou) for iou in ious]
        score = mask_precision(truth, found, [category]).by_category[name]
        np.testing.assert_allclose(score.by_iou, expected, atol=1e-6)
        assert score.ap_thesis == pytest.approx(np.mean(expected), abs=1e-6)
        assert score.ap_thesis != pytest.approx(score.ap, abs=0.01)


def test_perfect_masks_score_one_by_every_measure() -> None:
    truth, _ = _scene(0)
    found = [CocoResult(a.image_id, a.category_id, a.mask, 0.9) for a in truth.annotations if not a.is_crowd]
    mean = mask_precision(truth, found, [PERSON, CAR]).mean
    assert (mean.ap, mean.ap_thesis, mean.recall) == (pytest.approx(1), pytest.approx(1), 1.0)


def test_nothing_found_scores_zero() -> None:
    truth, _ = _scene(0)
    score = mask_precision(truth, [], [PERSON, CAR])
    assert (score.mean.ap, score.mean.ap_thesis, score.mean.recall) == (0.0, 0.0, 0.0)
    assert found_scores(truth, [], [CAR])["car"].precision is None
    assert found_scores(truth, [], [CAR])["car"].recall == 0.0


def test_what_was_found_on_an_image_without_truth_is_wrong() -> None:
    truth, found = _scene(0)
    before = mask_precision(truth, found, [PERSON]).mean.ap
    invented = CocoResult(10, PERSON, encode_mask(_box_mask(5, 5, 50, 50)), 1.0)
    after = mask_precision(truth, [*found, invented], [PERSON]).mean.ap
    assert before is not None
    assert after is not None
    assert after < before


def test_an_id_of_zero_is_no_reason_to_miss_an_instance() -> None:
    mask = encode_mask(_box_mask(5, 5, 50, 50))
    truth = CocoDataset((CocoImage(0, "a", WIDTH, HEIGHT),), (CocoCategory(3, "car"),), (
        CocoAnnotation.of_mask(0, 0, 3, mask),
    ))  # fmt: skip
    assert mask_precision(truth, [CocoResult(0, 3, mask, 0.5)], [3]).mean.ap == pytest.approx(1.0)


def test_no_truth_at_all_is_one_clear_line() -> None:
    truth, found = _scene(0)
    with pytest.raises(InputError, match="12 images without a true instance of bus"):
        mask_precision(truth, found, [BUS])


def _heights(*rows: tuple[int, int, bool, float | None]) -> tuple[CocoDataset, list[CocoResult]]:
    """Cars of (x, height, is true, score or not found), all 20 px wide."""
    masks = [encode_mask(_box_mask(x, 10, 20, height)) for x, height, _, _ in rows]
    truth = [CocoAnnotation.of_mask(n, 1, CAR, m) for n, (m, row) in enumerate(zip(masks, rows, strict=True)) if row[2]]
    found = [CocoResult(1, CAR, m, row[3]) for m, row in zip(masks, rows, strict=True) if row[3] is not None]
    return CocoDataset((CocoImage(1, "a", WIDTH, HEIGHT),), (CocoCategory(CAR, "car"),), tuple(truth)), found


def test_precision_and_recall_of_tall_objects_by_hand() -> None:
    truth, found = _heights(
        (0, 50, True, 0.9),  # found
        (25, 60, True, None),  # missed
        (50, 20, True, None),  # too small to be missed
        (75, 20, True, 0.8),  # too small to count as found
        (100, 50, False, 0.7),  # wrong
        (125, 20, False, 0.6),  # too small to be wrong
        (150, 45, True, 0.2),  # found, not surely enough
    )
    score = found_scores(truth, found, [CAR], FoundRules(0.5, 40.0, 0.3))["car"]
    assert (score.true_positives, score.false_positives, score.false_negatives) == (1, 1, 2)
    assert score.precision == 0.5
    assert score.recall == pytest.approx(1 / 3)
    np.testing.assert_allclose(score.scores, [0.9, 0.7, 0.2])
    np.testing.assert_allclose(score.precisions, [1, 1 / 2, 2 / 3])
    np.testing.assert_allclose(score.recalls, [1 / 3, 1 / 3, 2 / 3])
    assert score.recall_at(0.6) == pytest.approx(2 / 3)
    assert score.recall_at(0.9) == pytest.approx(1 / 3)


def test_confusion_by_hand() -> None:
    truth, found = _heights(
        (0, 50, True, 0.9),  # found as what it is
        (25, 60, True, None),  # missed
        (50, 20, True, 0.9),  # too small
        (75, 50, False, 0.7),  # nothing there
        (100, 45, True, 0.2),  # not surely enough: missed
        (150, 45, True, 0.8),  # a bus, below
    )
    found[-1] = CocoResult(1, BUS, found[-1].mask, 0.8)
    truth = CocoDataset(truth.images, (*truth.categories, CocoCategory(BUS, "bus")), truth.annotations)
    confusion = class_confusion(truth, found, FoundRules(0.5, 40.0, 0.3))
    assert confusion.names == ("car", "bus")
    assert confusion.counts.tolist() == [[1, 1, 2], [0, 0, 0], [1, 0, 0]]


def test_without_a_least_height_it_is_pycocotools_recall(written: Path) -> None:
    truth = read_coco(written / "truth.json")
    found = read_coco_results(written / "found.json", truth)
    score = found_scores(truth, found, [CAR], FoundRules(0.5, 0.0, 0.0))["car"]
    reference = _reference(written, [CAR], np.array([0.5]))
    assert score.recall == pytest.approx(float(reference.eval["recall"][0, 0, 0, -1]), abs=1e-6)
    assert score.recall == pytest.approx(score.recalls[-1])
