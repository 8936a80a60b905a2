# SPDX-License-Identifier: Apache-2.0
"""One segmenter over KITTI's semantic-instance images."""

from collections.abc import Sequence

from schemas.categories import category_id
from services.cli.thesis.segmenter_run import TimedSegmenter, read_image
from services.evaluation.progress import Progress, silent
from services.evaluation.thesis.instances import SegmenterScore, score_segmenter
from services.formats.coco import CocoAnnotation, CocoImage, CocoResult
from services.formats.kitti_semantic import SemanticFrame, annotations, read_instances
from services.formats.rle import encode_mask
from services.runtime.errors import InputError


def score_on_kitti(
    name: str,
    segmenter: TimedSegmenter,
    frames: Sequence[SemanticFrame],
    category: str,
    progress: Progress = silent,
) -> SegmenterScore:
    """Segment every image and score what was found of `category`.

    Raises:
        InputError: what cannot be read, a truth of another size than its image, no true instance at all, or a
            segmenter that had no word about any image.
    """
    images: list[CocoImage] = []
    truth: list[CocoAnnotation] = []
    found: list[CocoResult] = []
    skipped = 0
    for number, frame in enumerate(progress(frames, f"segmenting, {name}"), start=1):
        pixels, labels = read_image(frame.image), read_instances(frame)
        if labels.shape != pixels.shape[:2]:
            raise InputError(
                f"{frame.instance}: {labels.shape[1]}x{labels.shape[0]} px, "
                f"expected {pixels.shape[1]}x{pixels.shape[0]} as its image"
            )
        images.append(CocoImage(number, frame.name, labels.shape[1], labels.shape[0]))
        truth += annotations(labels, images[-1], category, len(truth) + 1)
        instances = segmenter.segment(frame.name, pixels)
        skipped += instances.skipped
        for item in instances.instances:
            mask = encode_mask(instances.labels == item.instance_id)
            found.append(CocoResult(number, category_id(item.category), mask, item.score))
    if skipped == len(frames):
        raise InputError(f"{name}: no word about any image, expected frames named such as {frames[0].name!r}")
    return score_segmenter(
        name, images, truth, found, category, seconds=segmenter.seconds, skipped=skipped, progress=progress
    )
