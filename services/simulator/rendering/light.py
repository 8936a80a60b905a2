# SPDX-License-Identifier: Apache-2.0
"""Where a world's light comes from, and how much of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from services.simulator.options import Light as LightName

Colour = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Light:
    """All colours are blue, green, red; those of light are factors, those of haze and sky go from 0 to 255.

    to_sun: direction in the world frame, of any length. sun: where it falls straight onto a surface. sky, ground: what
    comes from above and from below. haze_length_m: where 63 % of a colour has become the haze's. clouds: share of the
    sky that is its texture; the rest goes from `horizon` to `zenith`. glow: of the sky round the sun. contact_shade:
    share of the light that is missing on the ground under somebody.
    """

    to_sun: Colour
    sun: Colour
    sky: Colour
    ground: Colour
    haze: Colour
    haze_length_m: float
    clouds: float = 1.0
    horizon: Colour = (0.0, 0.0, 0.0)
    zenith: Colour = (0.0, 0.0, 0.0)
    glow: Colour = (0.0, 0.0, 0.0)
    contact_shade: float = 0.75

    @property
    def direction_to_sun(self) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        """Unit vector, (3,)."""
        vector = np.array(self.to_sun)
        return np.asarray(vector / np.linalg.norm(vector))

    @property
    def casts_shadows(self) -> bool:
        """Whether the sun is out."""
        return any(self.sun)


LIGHTS: dict[LightName, Light] = {
    "noon": Light(
        to_sun=(0.42, 0.36, 0.83),
        sun=(0.62, 0.62, 0.62),
        sky=(0.50, 0.50, 0.50),
        ground=(0.40, 0.40, 0.40),
        haze=(226.0, 214.0, 204.0),
        haze_length_m=700.0,
    ),
    "low_sun": Light(
        to_sun=(0.80, 0.52, 0.24),
        sun=(0.66, 0.90, 1.10),
        sky=(0.60, 0.52, 0.47),
        ground=(0.30, 0.32, 0.35),
        haze=(176.0, 204.0, 226.0),
        haze_length_m=480.0,
        clouds=0.35,
        horizon=(170.0, 212.0, 246.0),
        zenith=(214.0, 164.0, 122.0),
        glow=(120.0, 190.0, 240.0),
    ),
    "overcast": Light(
        to_sun=(0.0, 0.0, 1.0),
        sun=(0.0, 0.0, 0.0),
        sky=(0.80, 0.78, 0.76),
        ground=(0.40, 0.40, 0.40),
        haze=(196.0, 194.0, 192.0),
        haze_length_m=420.0,
        clouds=0.15,
        horizon=(206.0, 204.0, 202.0),
        zenith=(180.0, 176.0, 172.0),
    ),
    "dusk": Light(
        to_sun=(0.80, 0.52, -0.05),
        sun=(0.0, 0.0, 0.0),
        sky=(0.46, 0.37, 0.34),
        ground=(0.19, 0.18, 0.18),
        haze=(112.0, 92.0, 88.0),
        haze_length_m=420.0,
        clouds=0.12,
        horizon=(118.0, 128.0, 176.0),
        zenith=(96.0, 58.0, 40.0),
        glow=(20.0, 60.0, 110.0),
    ),
}
