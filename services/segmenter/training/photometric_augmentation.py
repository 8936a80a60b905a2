# SPDX-License-Identifier: Apache-2.0
"""What changes an image's colours but not its content: light, colour, sensor. Masks stay."""

from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from services.segmenter.training.sample import Sample


@dataclass(frozen=True)
class Photometric:
    """Brightness, contrast, gamma, saturation, hue, white balance, blur, noise, JPEG, grey: each by chance.

    Strong on purpose (domain randomisation, Tobin et al., IROS 2017): a network that learns from rendered images must
    not rely on how they look.
    """

    strength: float = 1.0

    def __call__(self, sample: Sample, random: np.random.Generator) -> Sample:
        image: npt.NDArray[np.float32] = np.divide(sample.image, 255, dtype=np.float32)
        strength = self.strength
        if random.random() < 0.8:
            image = self._colours(image, random)
        if random.random() < 0.5:
            gamma = float(np.exp(random.uniform(-0.6, 0.6) * strength))
            image = np.power(np.clip(image, 0, 1), gamma, dtype=np.float32)
        if random.random() < 0.3:
            sigma = random.uniform(0.3, 1.5) * strength
            image = np.asarray(cv2.GaussianBlur(image, (0, 0), sigma), np.float32)
        if random.random() < 0.5:
            image = image + random.normal(0, random.uniform(0.005, 0.05) * strength, image.shape).astype(np.float32)
        if random.random() < 0.25:
            grey = image @ np.array([0.114, 0.587, 0.299], np.float32)
            image = np.repeat(grey[..., None], 3, axis=2)
        levels = (np.clip(image, 0, 1) * 255 + 0.5).astype(np.uint8)
        if random.random() < 0.3:
            quality = int(random.integers(25, 90))
            _, coded = cv2.imencode(".jpg", levels, [cv2.IMWRITE_JPEG_QUALITY, quality])
            levels = np.asarray(cv2.imdecode(coded, cv2.IMREAD_COLOR), np.uint8)
        return Sample(levels, sample.masks, sample.labels)

    def _colours(self, image: npt.NDArray[np.float32], random: np.random.Generator) -> npt.NDArray[np.float32]:
        strength = self.strength
        balance = np.exp(random.normal(0, 0.08 * strength, 3)).astype(np.float32)
        image = image * balance * np.float32(np.exp(random.uniform(-0.4, 0.4) * strength))
        mean = image.mean(dtype=np.float64)
        image = (image - mean) * np.float32(np.exp(random.uniform(-0.4, 0.4) * strength)) + mean
        grey = image.mean(axis=2, keepdims=True)
        image = grey + (image - grey) * np.float32(random.uniform(0.2, 1.6))
        if random.random() < 0.2 * strength:
            image = image[..., random.permutation(3)]
        return np.asarray(image, np.float32)
