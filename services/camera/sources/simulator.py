# SPDX-License-Identifier: Apache-2.0
"""The simulator's street as a source, with all its truth."""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from schemas.records import CameraCalibration, DepthImage, Image, TrueInstances, TrueObject, TruePose
from services.camera.sources.source import SourceFrame
from services.simulator.options import DriveOptions

if TYPE_CHECKING:
    from services.simulator.drive import Drive


class Simulator:
    """A drive through the street that `options` describe; image, depth, true pose and true instances.

    The world is built when the first frame is asked for: an input that is only looked at costs nothing.
    """

    def __init__(self, options: DriveOptions) -> None:
        self._options = options
        self._street: Drive | None = None

    @property
    def name(self) -> str:
        return f"simulator, seed {self._options.seed}"

    @property
    def frame_count(self) -> int:
        return self._options.frames

    @property
    def rate_hz(self) -> float:
        return self._options.rate_hz

    @property
    def notes(self) -> tuple[str, ...]:
        return ()

    def frame(self, index: int) -> SourceFrame | None:
        if index >= self._options.frames:
            return None
        if self._street is None:
            # The renderer costs seconds to load; whoever reads a folder does without.
            from services.simulator.drive import Drive

            self._street = Drive(self._options)
        seen = self._street.render(index)
        time_ns = seen.timestamp_ns
        camera = self._street.camera
        return SourceFrame(
            f"{index:06d}",
            time_ns,
            Image(time_ns, seen.image),
            CameraCalibration(time_ns, camera.width, camera.height, camera.k),
            depth=DepthImage(time_ns, seen.depth_m),
            true_pose=TruePose(time_ns, seen.world_from_camera),
            true_instances=TrueInstances(
                time_ns,
                seen.labels.astype(np.uint32),
                tuple(
                    TrueObject(
                        instance.instance_id,
                        instance.category,
                        instance.moving,
                        _xyz(instance.velocity_m_s),
                        _xyz(instance.position_m),
                        instance.box_px,
                    )
                    for instance in seen.instances
                ),
            ),
        )

    def close(self) -> None:
        """Nothing is held open."""


def _xyz(vector: npt.NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z
