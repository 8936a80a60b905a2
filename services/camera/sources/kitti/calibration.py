# SPDX-License-Identifier: Apache-2.0
"""KITTI's calib.txt and calib_cam_to_cam.txt: the projection matrices P0..P3 of the rectified cameras.

Source: Geiger et al., "Vision meets Robotics: The KITTI Dataset", IJRR 2013; the odometry benchmark's readme.
"""

import re
from pathlib import Path

import numpy as np
import numpy.typing as npt

from services.camera.sources.folders.number_rows import parse_numbers, read_lines
from services.runtime.errors import InputError

# P2 in the benchmarks' calib.txt, P_rect_02 in the raw recordings' calib_cam_to_cam.txt.
_PROJECTION_NAME = re.compile(r"P(?:_rect_0)?(\d):?")


def read_projections(path: Path) -> dict[str, npt.NDArray[np.float64]]:
    """P0..P3 as far as the file has them, each (3, 4) [K | K t] in px and px m; t leads from camera 0 to this one.

    Raises:
        InputError: no such file, no projection in it, a line without 12 finite numbers, a focal length that is not
            positive; names file, line, found and expected.
    """
    if not path.is_file():
        raise InputError(f"calibration {path}: no such file, expected KITTI's calib.txt with a line 'P0: <12 numbers>'")
    projections = {}
    for line_number, line in read_lines(path):
        name, *numbers = line.split(maxsplit=1)
        match = _PROJECTION_NAME.fullmatch(name)
        if match is None:
            continue
        projection = np.reshape(parse_numbers(path, line_number, "".join(numbers), 12), (3, 4))
        if projection[0, 0] <= 0 or projection[1, 1] <= 0 or projection[2, 2] != 1:
            raise InputError(
                f"{path} line {line_number}: focal lengths {projection[0, 0]:g} and {projection[1, 1]:g} px over "
                f"{projection[2, 2]:g}, expected positive ones over 1"
            )
        projections[f"P{match[1]}"] = projection
    if not projections:
        raise InputError(f"{path}: no projection matrix, expected a line 'P0: <12 numbers>'")
    return projections


def camera_0_from(projection: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """(4, 4) camera0_from_camera in metres of a rectified camera's projection: both look the same way."""
    transform = np.eye(4)
    transform[:3, 3] = -np.linalg.solve(projection[:, :3], projection[:, 3])
    return transform
