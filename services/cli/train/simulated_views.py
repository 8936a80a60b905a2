# SPDX-License-Identifier: Apache-2.0
"""Views of many simulated places in every light, none of them next to another."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import cycle

import cv2
import numpy as np
import numpy.typing as npt

from services.simulator.options import DriveOptions, Light, WorldName

_LIGHTS: tuple[Light, ...] = ("noon", "overcast", "low_sun", "dusk")
_RATE_HZ = 10.0
_ALONG_M: dict[WorldName, float] = {"town": 480.0, "street": 240.0, "corridor": 40.0}
"""How far a drive's views are spread."""
_SIZES: tuple[tuple[int, int], ...] = ((1242, 375), (640, 192), (752, 480))


@dataclass(frozen=True)
class SimulatedViews:
    """`drives` drives, `views` of each. Worlds, sizes and lights take turns; seeds count up from `first_seed`.

    Three of five drives go through a town, one through a street, one through a corridor.
    """

    first_seed: int = 1001
    drives: int = 20
    views: int = 16
    worlds: tuple[WorldName, ...] = ("town", "street", "town", "corridor", "town")

    def __len__(self) -> int:
        return self.drives * self.views

    def __iter__(self) -> Iterator[npt.NDArray[np.uint8]]:
        """Grey images (H, W)."""
        from services.simulator.drive import Drive

        turns = zip(range(self.drives), cycle(self.worlds), cycle(_LIGHTS), cycle(_SIZES), strict=False)
        for number, world, light, size in turns:
            drive = Drive(self._options(number, world, light, size))
            for index in np.linspace(0, drive.frame_count - 1, self.views).round().astype(int):
                image = cv2.cvtColor(drive.render(int(index)).image, cv2.COLOR_BGR2GRAY)
                yield np.asarray(image, np.uint8)

    def _options(self, number: int, world: WorldName, light: Light, size: tuple[int, int]) -> DriveOptions:
        own = DriveOptions(world=world)
        return DriveOptions(
            world=world,
            seed=self.first_seed + number,
            frames=int(_ALONG_M[world] / own.speed_m_s * _RATE_HZ),
            rate_hz=_RATE_HZ,
            light=light,
            width=size[0],
            height=size[1],
            noise=1.0,
        )
