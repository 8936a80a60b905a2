# SPDX-License-Identifier: Apache-2.0
"""What shutter and sensor make of the light, in the order in which it meets them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.camera.exposure import ExposureWobble
from services.simulator.camera.linear_light import image_of, light_of
from services.simulator.camera.motion_blur import MotionBlur
from services.simulator.camera.noise import SensorNoise
from services.simulator.camera.pixel_rain import PixelRain
from services.simulator.options import DriveOptions

_TAG = 104
_DARK_NOISE = 6.0
"""A sensor without light shows at least the noise of one with so many grey levels of it."""


class Sensor:
    """Blur, exposure, noise, pixel rain; without any of them the image is left as it is.

    Everything follows from the seed, the frame and the eye (0 left, 1 right).
    """

    def __init__(self, options: DriveOptions) -> None:
        self._seed = options.seed
        self.blur = MotionBlur(options.motion_blur) if options.motion_blur else None
        self._wobble = ExposureWobble(options.exposure_wobble, options.seed) if options.exposure_wobble else None
        self._noise = SensorNoise(options.noise) if options.noise else None
        self._dark_noise = SensorNoise(max(options.noise, _DARK_NOISE))
        self._rain = PixelRain(options.pixel_rain) if options.pixel_rain else None

    def exposed(
        self, image: NDArray[np.uint8], flow_px: NDArray[np.float32] | None, index: int, t_s: float, eye: int
    ) -> NDArray[np.uint8]:
        """An image (H, W, 3) as the sensor sees it. flow_px: (H, W, 2) to the next frame time, None: no blur."""
        rng = np.random.default_rng([self._seed, _TAG, index, eye])
        blurred = self.blur is not None and flow_px is not None
        if blurred or self._wobble is not None or self._noise is not None:
            light = light_of(image)
            if self.blur is not None and flow_px is not None:
                light = self.blur.spread(light, flow_px)
            if self._wobble is not None:
                light = light * np.float32(self._wobble.gain(t_s))
            if self._noise is not None:
                light = self._noise.added(light, rng)
            image = image_of(light)
        return self._rained_on(image, rng)

    def black(self, shape: tuple[int, ...], index: int, eye: int) -> NDArray[np.uint8]:
        """The image without any light."""
        rng = np.random.default_rng([self._seed, _TAG, index, eye])
        return self._rained_on(image_of(self._dark_noise.added(np.zeros(shape, np.float32), rng)), rng)

    def _rained_on(self, image: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
        if self._rain is not None:
            self._rain.fall(image, rng)
        return image
