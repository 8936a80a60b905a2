# SPDX-License-Identifier: Apache-2.0
"""The simulator as a source, with all its truth."""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from schemas.records import CameraCalibration, DepthImage, Image, TrueInstances, TrueObject, TruePose
from services.camera.sources.source import SourceFrame
from services.simulator.camera.camera import Camera
from services.simulator.camera.timeline import Timeline
from services.simulator.options import DriveOptions

if TYPE_CHECKING:
    from services.simulator.drive import Drive

_RIGHT = "camera_right"


class Simulator:
    """The drive that `options` describe: image (and the right one of a pair), depth, true pose and true instances.

    Lens and pair: depth and truth belong to the left image as it is, distorted where the lens distorts; both cameras
    have the same lens, and the right one's projection says how far it stands to the right (P[0, 3] = -fx * baseline).

    The world is built when the first frame is asked for: an input that is only looked at costs nothing.

    Raises:
        InputError: options that no camera can meet.
    """

    def __init__(self, options: DriveOptions) -> None:
        # A lens that shows nothing and a drive that never ends are found here, not at the first frame.
        Camera.from_options(options)
        Timeline(options)
        self._options = options
        self._drive: Drive | None = None

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
        if self._drive is None:
            # The renderer costs seconds to load; whoever reads a folder does without.
            from services.simulator.drive import Drive

            self._drive = Drive(self._options)
        seen = self._drive.render(index)
        time_ns = seen.timestamp_ns
        camera, baseline_m = self._drive.camera, self._options.stereo_baseline_m
        pair = seen.image_right is not None
        return SourceFrame(
            f"{index:06d}",
            time_ns,
            Image(time_ns, seen.image),
            _calibration(time_ns, camera, camera.projection() if pair else None, "camera"),
            image_right=None if seen.image_right is None else Image(time_ns, seen.image_right, _RIGHT),
            calibration_right=_calibration(time_ns, camera, camera.projection(baseline_m), _RIGHT) if pair else None,
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
                        instance.heading_rad,
                        instance.size_m,
                    )
                    for instance in seen.instances
                ),
            ),
        )

    def close(self) -> None:
        """Nothing is held open."""


def _calibration(
    time_ns: int, camera: Camera, projection: npt.NDArray[np.float64] | None, frame_id: str
) -> CameraCalibration:
    return CameraCalibration(
        time_ns,
        camera.width,
        camera.height,
        camera.k,
        camera.lens.coefficients,
        projection,
        frame_id,
        camera.lens.model,
    )


def _xyz(vector: npt.NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z
