# SPDX-License-Identifier: Apache-2.0
"""Whether targets, losses and decoding belong together: a few images, learned by heart, must be found again.

    python -m tests.benchmark.segmenter.learn_by_heart FOLDER... [--images 16] [--steps 300]

FOLDERs are of `kinemap train scenes`. Prints the mask AP on the very images that were learned; it must go to 0.8 and
more, or something is at odds.
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np
import torch

from services.cli.train.training_data import parse_training_data, read_samples
from services.evaluation.instance_masks.average_precision import mask_precision
from services.formats.coco import CocoAnnotation, CocoCategory, CocoDataset, CocoImage, CocoResult
from services.formats.rle import encode_mask
from services.segmenter.solov2.instances import InstanceOptions, instances_of
from services.segmenter.solov2.network import SoloV2
from services.segmenter.solov2.preprocessing import normalized
from services.segmenter.training.geometric_augmentation import RandomScale
from services.segmenter.training.sample import Sample
from services.segmenter.training.trainer import Trainer, TrainingOptions

_LEAST_PX = 400
"""of an instance: outlines of smaller ones are coarser than the mask features, whatever is learned"""


class _Few:
    """Images that stay the same."""

    def __init__(self, samples: list[Sample]) -> None:
        self._samples = samples

    def __len__(self) -> int:
        return len(self._samples)

    def __getitem__(self, index: int, /) -> Sample:
        return self._samples[index]

    def aspect(self, index: int, /) -> float:
        height, width = self._samples[index].image.shape[:2]
        return width / height


class _Unchanged:
    def apply(self, sample: Sample, *_: object) -> Sample:
        return sample


def _images(folders: list[str], count: int, size: tuple[int, int]) -> list[Sample]:
    """Whole images, fitted into `size`."""
    samples = read_samples([parse_training_data(folder) for folder in folders], _categories())
    random = np.random.default_rng(0)
    fit = RandomScale(size, scales=(1.0, 1.0), aspect=0.0, least_px=_LEAST_PX)
    found: list[Sample] = []
    for number in random.permutation(len(samples)):
        sample = fit(samples[int(number)], random)
        if len(sample.labels) and len(found) < count:
            found.append(sample)
    return found


def _categories() -> tuple[str, ...]:
    return ("person", "bicycle", "car", "motorcycle", "bus", "train", "truck")


def _truth(samples: list[Sample]) -> CocoDataset:
    images, annotations = [], []
    for number, sample in enumerate(samples, start=1):
        height, width = sample.image.shape[:2]
        images.append(CocoImage(number, f"{number}.png", width, height))
        for mask, label in zip(sample.masks, sample.labels.tolist(), strict=True):
            row = CocoAnnotation.of_mask(len(annotations) + 1, number, label + 1, encode_mask(mask), {})
            annotations.append(row)
    names = tuple(CocoCategory(place + 1, name) for place, name in enumerate(_categories()))
    return CocoDataset(tuple(images), names, tuple(annotations), {})


@torch.inference_mode()
def _found(network: SoloV2, samples: list[Sample]) -> list[CocoResult]:
    results = []
    for number, sample in enumerate(samples, start=1):
        size = (sample.image.shape[0], sample.image.shape[1])
        output = network(torch.from_numpy(normalized(sample.image))[None])
        instances = instances_of(output, size, size, InstanceOptions(least_area=network.variant.least_area))
        for mask, label, score in zip(instances.masks, instances.labels, instances.scores, strict=True):
            results.append(CocoResult(number, int(label) + 1, encode_mask(mask.numpy()), float(score)))
    return results


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--images", type=int, default=16)
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--batch", type=int, default=8)
    parser.add_argument("--rate", type=float, default=1e-3)
    parser.add_argument("--variant", default="solov2-compact_lite0")
    parser.add_argument("--precision", default="auto")
    arguments = parser.parse_args()
    torch.set_num_threads(1)
    size = (416, 224)
    samples = _images(arguments.folders, arguments.images, size)
    truth = _truth(samples)
    asked = sorted({item.category_id for item in truth.annotations})
    print(f"{len(samples)} images, {len(truth.annotations)} instances", flush=True)
    options = TrainingOptions(
        variant=arguments.variant,
        categories=_categories(),
        sizes=(size,),
        steps=arguments.steps,
        batch=arguments.batch,
        peak_learning_rate=arguments.rate,
        warm_up=20,
        cool_down=arguments.steps // 3,
        precision=arguments.precision,
    )
    with tempfile.TemporaryDirectory() as folder:
        trainer = Trainer(options, _Few(samples), Path(folder), torch.device("cpu"), augmentation=_Unchanged())
        while trainer.step < arguments.steps:
            losses: list[tuple[float, float]] = []
            trainer.run(
                min(arguments.steps, trainer.step + 25),
                lambda step, kept=losses: kept.append((step.category_loss, step.mask_loss)),  # type: ignore[misc]
            )
            category, mask = np.mean(losses, axis=0)
            said = f"step {trainer.step}: category {category:.3f}, mask {mask:.3f}"
            if trainer.step % 50 == 0 or trainer.step == arguments.steps:
                mean = mask_precision(truth, _found(trainer.averaged_network(), samples), asked).mean
                said += f", AP {mean.ap:.3f}, AP50 {mean.ap50:.3f}"
            print(said, flush=True)


if __name__ == "__main__":
    main()
