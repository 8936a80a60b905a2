# SPDX-License-Identifier: Apache-2.0
"""The sky: a texture over the upper half of all directions, and what the light makes of it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from services.simulator.rendering.light import Light

Floats32 = NDArray[np.float32]

_GLOW_WIDTH = 0.02
"""How fast the glow fades with 1 - cos of the angle from the sun."""
_SUN_COS = np.float32(np.cos(np.deg2rad(0.6)))


class Sky:
    """The sky under one light. Image directions are given as x / z and y / z, (N,), with the camera's axes (3, 3)."""

    def __init__(self, light: Light) -> None:
        self._light = light
        self.plain = light.clouds == 1.0
        """Whether the texture is the sky as it is."""

    def position(self, axes: Floats32, x: Floats32, y: Floats32) -> tuple[Floats32, Floats32]:
        """Position in the sky's texture: azimuth, and elevation from the horizon up."""
        direction = axes @ np.stack([x, y, np.ones_like(x)])
        azimuth = np.arctan2(direction[1], direction[0]) * np.float32(1.0 / np.pi)
        return azimuth, np.clip(1.0 - 2.2 * _rise(direction), 0.01, 0.99).astype(np.float32)

    def lit(self, colour: Floats32, axes: Floats32, x: Floats32, y: Floats32) -> Floats32:
        """Colours (N, 3) of the texture under this light."""
        light = self._light
        if self.plain:
            return colour
        direction = axes @ np.stack([x, y, np.ones_like(x)])
        rise = np.sqrt(np.clip(_rise(direction), 0.0, 1.0))[:, None]
        low, high = np.array(light.horizon, np.float32), np.array(light.zenith, np.float32)
        gradient = low + (high - low) * rise
        # The clouds keep their pattern and take the brightness of the sky behind them.
        colour = gradient * ((1.0 - light.clouds) + light.clouds * colour * np.float32(1.0 / 190.0))
        if any(light.glow):
            length = np.sqrt(np.square(direction).sum(axis=0))
            towards = light.direction_to_sun.astype(np.float32) @ direction / length
            colour += np.exp((towards[:, None] - 1.0) / _GLOW_WIDTH) * np.array(light.glow, np.float32)
            colour[(towards > _SUN_COS) & light.casts_shadows] = 255.0
        return np.asarray(colour, np.float32)


def _rise(direction: Floats32) -> Floats32:
    """Elevation as a share of a right angle."""
    return np.asarray(np.arctan2(direction[2], np.hypot(direction[0], direction[1])) * np.float32(2.0 / np.pi))
