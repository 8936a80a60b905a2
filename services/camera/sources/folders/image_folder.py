# SPDX-License-Identifier: Apache-2.0
"""A folder of images of one's own camera, with a calibration file beside them."""

from pathlib import Path

from services.camera.sources.calibration_file import CALIBRATION_NAMES, find_calibration, read_calibration
from services.camera.sources.folders.image_files import ImageFiles
from services.camera.sources.folders.number_rows import times_of_folder
from services.camera.sources.indexed_source import CameraImages, IndexedSource

_IMAGES = "images"


class ImageFolder(IndexedSource):
    """Images (or a subfolder `images` of them) in the order of their names, calibration.toml or calib.txt, times.txt.

    Args:
        folder: the folder with the images, or the one above `images`.
        calibration: the calibration file; None looks for it in the folder.
        rate_hz: images a second where there is no times.txt; None takes the calibration file's, or 10.

    Raises:
        InputError: whatever of the folder cannot be used, by file.
    """

    def __init__(self, folder: Path, *, calibration: Path | None = None, rate_hz: float | None = None) -> None:
        images = ImageFiles(folder / _IMAGES if (folder / _IMAGES).is_dir() else folder)
        model = read_calibration(find_calibration(calibration, *(folder / name for name in CALIBRATION_NAMES)))
        camera = model.for_images(images.size, images.paths[0]).record(0)
        times_ns, rate_hz, notes = times_of_folder(folder, images.paths, rate_hz or model.rate_hz)
        super().__init__(
            f"images of {folder.resolve().name}", times_ns, rate_hz, CameraImages(images, camera), notes=notes
        )
